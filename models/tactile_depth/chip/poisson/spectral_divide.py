# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/spectral_divide.sv, and the contents of its ROM."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor, round_saturate
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.transform.orders import eigenvalues
from tactile_depth.chip.resources import Parts, Words, products, rom

LATENCY = 4


@dataclass(frozen=True)
class Reciprocals:
    """1 / (lambda_k + lambda_l), scaled, as floating-point words: mantissa * 2**-(drop - shift).

    Attributes
    ----------
    mantissa : int64 array (N, N), negative, normalised to the coefficient width
    shift : int64 array (N, N), 0 for the smallest reciprocal
    drop : int, fraction bits dropped after the shift
    shift_width : int, bits of the shift
    """

    mantissa: np.ndarray
    shift: np.ndarray
    drop: int
    shift_width: int


@cache
def reciprocals(config: Configuration) -> Reciprocals:
    """Return the reciprocals by position of both modes, scaled to depth codes and for the gain of the coefficients."""
    eigenvalue = eigenvalues(config.columns, config.neumann)
    total = eigenvalue[:, None] + eigenvalue[None, :]
    singular = total == 0  # Neumann: the constant, which is set to 0 for zero mean
    factor = ~singular / np.where(singular, 1, total) / config.transform_gain / config.depth_limit_px
    scaled = factor * 2.0 ** (config.column_inverse.fraction - config.column_forward.fraction)
    fraction, exponent = np.frexp(scaled)
    mantissa = np.rint(fraction * 2**config.coefficient.fraction).astype(np.int64)
    lowest = min(int(exponent[~singular].min()), config.coefficient.width - 2)  # at least one bit is dropped
    shift = np.where(singular, 0, exponent.astype(np.int64) - lowest)
    return Reciprocals(mantissa, shift, config.coefficient.fraction - lowest, max(1, int(shift.max()).bit_length()))


def spectral_divide(modes: np.ndarray, config: Configuration, monitor: Monitor | None = None) -> np.ndarray:
    """Divide modes (..., N, N), both axes in bit-reversed order, by the eigenvalues of the Laplacian."""
    table = reciprocals(config)
    product = modes * table.mantissa
    # (product << shift) >> drop within 64 bits. A left shift is needed only if less than one bit would be dropped.
    drop = np.maximum(table.drop - table.shift, 1)
    lift = np.int64(1) << drop - (table.drop - table.shift)
    return round_saturate(product * lift, drop, config.arithmetic_width, monitor, "spectral_divide")


def reciprocal_rom(config: Configuration) -> np.ndarray:
    """Return the ROM words {shift, mantissa} of the lower triangle, (p, t <= p) at p (p + 1) / 2 + t, int64."""
    table = reciprocals(config)
    lower = np.tril_indices(config.columns)
    mask = (1 << config.coefficient.width) - 1
    return table.shift[lower] << config.coefficient.width | table.mantissa[lower] & mask


def parts(config: Configuration) -> Parts:
    size = config.columns
    return [
        Words(config.depth.width),
        *products(config, 1),
        rom(reciprocals(config).shift_width + config.coefficient.width, size * (size + 1) // 2),
    ]
