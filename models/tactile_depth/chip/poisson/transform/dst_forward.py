# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/dst_forward.sv: DST-II of a burst by Makhoul's method."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common.td_rom import LATENCY as MEMORY_READ
from tactile_depth.chip.common.td_round_saturate import Monitor, round_saturate
from tactile_depth.chip.poisson.transform.sdf_fft import latency as sdf_fft_latency
from tactile_depth.chip.poisson.transform.sdf_fft import sdf_fft
from tactile_depth.chip.poisson.transform.twiddle_multiply import LATENCY as TWIDDLE_MULTIPLY
from tactile_depth.chip.poisson.transform.twiddle_multiply import phase_factors, twiddle_multiply

SIGN = 2  # cycles of sign and rounding


def alternate_sign(x: np.ndarray) -> np.ndarray:
    """Negate the samples of odd index of bursts (..., N) in Makhoul order, which are the second half.

    The sign (-1)^n changes a DST-II into a DCT-II of reversed modes.
    """
    y = x.copy()
    y[..., y.shape[-1] // 2 :] *= -1
    return y


def dst_forward(
    x: np.ndarray,
    input_drop: int,
    width: int,
    coefficient_width: int,
    output_drop: int,
    output_width: int,
    monitor: Monitor | None = None,
    node: str = "dst_forward",
    alternate: bool = True,
) -> np.ndarray:
    """Compute the DST-II along the last axis.

    Parameters
    ----------
    x : int64 array (..., N), Makhoul order
    input_drop, output_drop : int
        Fraction bits dropped between the input and the `width` bits of the arithmetic (negative: added), and between
        the arithmetic and the `output_width` bits of the output.
    alternate : bool
        If False, the sign (-1)^n is left out, and the transform is a DCT-II.

    Returns
    -------
    int64 array (..., N): sum over n of x[n] sin(pi (2n + 1) (N - k) / 2N) at position p,
    k = bit_reversed(N)[p], times the gain
    2**-halvings (1 - 2**(1 - coefficient_width)) ** (twiddle_stages + 1).
    """
    signed = round_saturate(alternate_sign(x) if alternate else x, input_drop, width, monitor, node + ".input")
    re, im = sdf_fft(signed, np.zeros_like(signed), False, width, coefficient_width, monitor, node + ".fft")
    factors = phase_factors(x.shape[-1], False, coefficient_width)
    drop = coefficient_width - 1 + output_drop
    output = node + ".phase"
    return twiddle_multiply(re, im, factors, drop, output_width, monitor, output, real_only=True)[0]


def latency(size: int) -> int:
    """Return the latency of a transform: read of the memory at its input, sign, FFT, phase."""
    return MEMORY_READ + SIGN + sdf_fft_latency(size) + TWIDDLE_MULTIPLY
