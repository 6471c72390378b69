# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/dst_forward.sv: DST-II of a burst by Makhoul's method."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor, round_saturate
from tactile_depth.chip.poisson.transform.fft import fft
from tactile_depth.chip.poisson.transform.fft import latency as fft_latency
from tactile_depth.chip.poisson.transform.fft import parts as fft_parts
from tactile_depth.chip.poisson.transform.transform import Transform
from tactile_depth.chip.poisson.transform.twiddle import LATENCY as TWIDDLE
from tactile_depth.chip.poisson.transform.twiddle import factors_rom, phase_factors, twiddle
from tactile_depth.chip.resources import Parts, Sizes, Words, products

SIGN = 1  # cycles of sign and rounding


def alternate_sign(x: np.ndarray) -> np.ndarray:
    """Negate the samples of odd index of bursts (..., N) in Makhoul order, which are the second half.

    The sign (-1)^n changes a DST-II into a DCT-II of reversed modes.
    """
    y = x.copy()
    y[..., y.shape[-1] // 2 :] *= -1
    return y


def dst_forward(
    x: np.ndarray, formats: Transform, monitor: Monitor | None = None, node: str = "dst_forward"
) -> np.ndarray:
    """Compute the DST-II along the last axis.

    Parameters
    ----------
    x : int64 array (..., N), Makhoul order

    Returns
    -------
    int64 array (..., N): sum over n of x[n] sin(pi (2n + 1) (N - k) / 2N) at position p,
    k = bit_reversed(N)[p], times the gain
    2**-halvings (1 - 2**(1 - factor_width)) ** (twiddle_stages + 1).
    """
    width, coefficients = formats.width, formats.factor_width
    signs = alternate_sign(x) if formats.alternate else x
    signed = round_saturate(signs, formats.input_drop, width, monitor, node + ".input")
    re, im = fft(signed, np.zeros_like(signed), False, width, coefficients, monitor, node + ".fft")
    factors, drop = phase_factors(x.shape[-1], False, coefficients), formats.factor_drop + formats.output_drop
    return twiddle(re, im, factors, drop, formats.output_width, monitor, node + ".phase", real_only=True)[0]


def latency(size: int, words: int) -> int:
    """Return the latency of a transform: sign, FFT, phase."""
    return SIGN + fft_latency(size, words) + TWIDDLE


def parts(config: Sizes) -> Parts:
    """Return those of the rows, and of the columns of the spectral solver; a phase gives its real part alone."""
    words = config.down_words
    factors = factors_rom(config, words, config.columns)
    instance = [
        Words(words * config.depth.width, work=1 / words),
        *fft_parts(config, words, False),
        *products(config, 2 * words),
        factors,
    ]
    return instance * (2 if config.solver == "spectral" else 1)
