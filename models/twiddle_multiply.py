# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/twiddle_multiply.sv, and the contents of its ROM."""

from __future__ import annotations

import numpy as np

from models.round_saturate import Monitor, round_saturate


def coefficient(x: np.ndarray, coefficient_width: int) -> np.ndarray:
    """Factors in [-1, 1] as signed words: 1 is 2**(w-1) - 1, so every product carries the same gain 1 - 2**(1-w).

    That gain is common to all words of a stage and is taken back once, at the end of the chain.
    """
    return np.rint(np.asarray(x) * (2 ** (coefficient_width - 1) - 1)).astype(np.int64)


def coefficient_gain(coefficient_width: int) -> float:
    """Gain of a multiplication by a `coefficient` of 1."""
    return 1 - 2.0 ** (1 - coefficient_width)


def twiddle_exponents(block: int) -> np.ndarray:
    """Exponent e of W_block**e for each word of a block, in stream order: quarters 0, 2n, n, 3n."""
    n = np.arange(block // 4)
    return np.concatenate((0 * n, 2 * n, n, 3 * n))


def twiddle_rom(block: int, inverse: bool, coefficient_width: int) -> np.ndarray:
    """Real and imaginary part of the twiddle factors, int64 (block, 2)."""
    angle = 2 * np.pi * twiddle_exponents(block) / block * (1 if inverse else -1)
    return coefficient(np.stack((np.cos(angle), np.sin(angle)), axis=-1), coefficient_width)


def twiddle_multiply(
    re: np.ndarray,
    im: np.ndarray,
    block: int,
    inverse: bool,
    width: int,
    coefficient_width: int,
    monitor: Monitor | None = None,
    node: str = "twiddle",
) -> tuple[np.ndarray, np.ndarray]:
    """Multiply each block of a stream (..., N) by its twiddle factors; saturated to `width` bits."""
    factors = twiddle_rom(block, inverse, coefficient_width)
    w_re, w_im = (np.tile(factors[:, part], re.shape[-1] // block) for part in (0, 1))
    drop = coefficient_width - 1
    return (
        round_saturate(re * w_re - im * w_im, drop, width, monitor, node + ".re"),
        round_saturate(re * w_im + im * w_re, drop, width, monitor, node + ".im"),
    )
