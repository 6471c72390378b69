# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/dst_inverse.sv: the inverse of dst_forward."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor, round_saturate
from tactile_depth.chip.poisson.transform.dst_forward import SIGN, alternate_sign
from tactile_depth.chip.poisson.transform.mode_pairs import latency as mode_pairs_latency
from tactile_depth.chip.poisson.transform.mode_pairs import mode_pairs
from tactile_depth.chip.poisson.transform.sdf_fft import latency as sdf_fft_latency
from tactile_depth.chip.poisson.transform.sdf_fft import sdf_fft
from tactile_depth.chip.poisson.transform.twiddle_multiply import LATENCY as TWIDDLE_MULTIPLY
from tactile_depth.chip.poisson.transform.twiddle_multiply import phase_factors, twiddle_multiply


def dst_inverse(
    modes: np.ndarray,
    input_drop: int,
    width: int,
    coefficient_width: int,
    output_drop: int,
    output_width: int,
    monitor: Monitor | None = None,
    node: str = "dst_inverse",
    alternate: bool = True,
) -> np.ndarray:
    """Compute the inverse DST-II along the last axis.

    Parameters
    ----------
    modes : int64 array (..., N), bit-reversed order, as dst_forward puts them out
    input_drop, output_drop : int
        Fraction bits dropped between the input and the `width` bits of the arithmetic (negative: added), and between
        the arithmetic and the `output_width` bits of the output.
    alternate : bool
        If False, the sign (-1)^n is left out, and the transform is an inverse DCT-II.

    Returns
    -------
    int64 array (..., N), Makhoul order: dst_inverse(dst_forward(x)) is x, times the coefficients' gain
    (1 - 2**(1 - coefficient_width)) ** (2 (twiddle_stages + 1)).
    """
    mode, mirrored = mode_pairs(modes)
    factors = phase_factors(modes.shape[-1], True, coefficient_width)
    drop = coefficient_width - 1 + input_drop
    re, im = twiddle_multiply(mirrored, mode, factors, drop, width, monitor, node + ".phase")
    re, im = sdf_fft(re, im, True, width, coefficient_width, monitor, node + ".fft")
    return round_saturate(alternate_sign(re) if alternate else re, output_drop, output_width, monitor, node + ".output")


def latency(size: int) -> int:
    """Return the latency of a transform: pairs, phase, FFT, sign."""
    return mode_pairs_latency(size) + TWIDDLE_MULTIPLY + sdf_fft_latency(size) + SIGN
