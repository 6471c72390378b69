# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/dst_inverse.sv: the inverse of dst_forward."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor, round_saturate
from tactile_depth.chip.poisson.transform.dst_forward import SIGN, alternate_sign
from tactile_depth.chip.poisson.transform.mode_pairs import latency as mode_pairs_latency
from tactile_depth.chip.poisson.transform.mode_pairs import mode_pairs
from tactile_depth.chip.poisson.transform.sdf_fft import latency as sdf_fft_latency
from tactile_depth.chip.poisson.transform.sdf_fft import parts as fft_parts
from tactile_depth.chip.poisson.transform.sdf_fft import sdf_fft
from tactile_depth.chip.poisson.transform.transform import Transform
from tactile_depth.chip.poisson.transform.twiddle_multiply import LATENCY as TWIDDLE_MULTIPLY
from tactile_depth.chip.poisson.transform.twiddle_multiply import phase_factors, twiddle_multiply
from tactile_depth.chip.resources import DISTRIBUTED, Memory, Multiplier, Parts, Sizes, Words, delay_line, rom


def dst_inverse(
    modes: np.ndarray, formats: Transform, monitor: Monitor | None = None, node: str = "dst_inverse"
) -> np.ndarray:
    """Compute the inverse DST-II along the last axis.

    Parameters
    ----------
    modes : int64 array (..., N), bit-reversed order, as dst_forward puts them out

    Returns
    -------
    int64 array (..., N), Makhoul order: dst_inverse(dst_forward(x)) is x, times the coefficients' gain
    (1 - 2**(1 - factor_width)) ** (2 (twiddle_stages + 1)).
    """
    mode, mirrored = mode_pairs(modes)
    width, coefficients = formats.width, formats.factor_width
    factors, drop = phase_factors(modes.shape[-1], True, coefficients), formats.factor_drop + formats.input_drop
    re, im = twiddle_multiply(mirrored, mode, factors, drop, width, monitor, node + ".phase")
    re, im = sdf_fft(re, im, True, width, coefficients, monitor, node + ".fft")
    signed = alternate_sign(re) if formats.alternate else re
    return round_saturate(signed, formats.output_drop, formats.output_width, monitor, node + ".output")


def latency(size: int) -> int:
    """Return the latency of a transform: pairs, phase, FFT, sign."""
    return mode_pairs_latency(size) + TWIDDLE_MULTIPLY + sdf_fft_latency(size) + SIGN


def parts(config: Sizes) -> Parts:
    """Return those of the words of the arithmetic, and of the stored words of the spectral solver; with mode_pairs."""
    size, coefficient, found = config.columns, config.coefficient.width, Parts()
    widths = [config.arithmetic_width, config.depth.width]
    for width in widths if config.solver == "spectral" else widths[:1]:
        found += [
            Words(config.depth.width),
            *[Multiplier(width, coefficient)] * 4,
            *delay_line(width, size // 2 + 1),
            Memory("row buffers", width, size, DISTRIBUTED),
            rom(3 * coefficient, size),
            *fft_parts(config, True),
        ]
    return found
