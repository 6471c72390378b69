# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/dst_inverse.sv: two rows in one complex transform, or every row alone."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor, round_saturate
from tactile_depth.chip.poisson.transform.dst_forward import alternate_sign
from tactile_depth.chip.poisson.transform.fft import fft
from tactile_depth.chip.poisson.transform.fft import latency as fft_latency
from tactile_depth.chip.poisson.transform.fft import parts as fft_parts
from tactile_depth.chip.poisson.transform.row_pairs import latency as row_pairs_latency
from tactile_depth.chip.poisson.transform.row_pairs import mode_pairs, row_pairs
from tactile_depth.chip.poisson.transform.transform import Transform
from tactile_depth.chip.poisson.transform.twiddle import LATENCY as TWIDDLE
from tactile_depth.chip.poisson.transform.twiddle import factors_rom, phase_factors, twiddle
from tactile_depth.chip.resources import Memory, Multiplier, Parts, Sizes, Words, delay_line

SIGN = 2  # cycles of sign and rounding


def dst_inverse(
    modes: np.ndarray, formats: Transform, monitor: Monitor | None = None, node: str = "dst_inverse"
) -> np.ndarray:
    """Compute the inverse DST-II along the last axis, every row alone.

    Parameters
    ----------
    modes : int64 array (..., N), bit-reversed order, as dst_forward puts them out

    Returns
    -------
    int64 array (..., N), Makhoul order: dst_inverse(dst_forward(x)) is x, times the coefficients' gain
    (1 - 2**(1 - factor_width)) ** (2 (twiddle_stages + 1)).
    """
    mode, mirrored = mode_pairs(modes)
    return _rounded(_transformed(mirrored, mode, formats, monitor, node)[0], formats, monitor, node)


def dst_inverse_pairs(
    modes: np.ndarray, formats: Transform, monitor: Monitor | None = None, node: str = "dst_inverse"
) -> np.ndarray:
    """Compute `dst_inverse` of rows, two in one complex FFT: one as its real part, the next as its imaginary part.

    Parameters
    ----------
    modes : int64 array (..., rows, N), words of `width` bits in bit-reversed order
        Rows in the order in which they enter, the first and the second as a pair. An odd last row has zeros beside it.

    Returns
    -------
    int64 array (..., rows, N), Makhoul order
    """
    rows, size = modes.shape[-2:]
    first, second = modes[..., 0::2, :], modes[..., 1::2, :]
    if rows % 2:
        second = np.concatenate((second, np.zeros_like(first[..., -1:, :])), axis=-2)
    re, im = row_pairs(first, second, formats.width, monitor, node + ".pair")
    pairs = np.stack(_transformed(re, im, formats, monitor, node), axis=-2)
    return _rounded(pairs.reshape(*modes.shape[:-2], -1, size)[..., :rows, :], formats, monitor, node)


def _transformed(
    re: np.ndarray, im: np.ndarray, formats: Transform, monitor: Monitor | None, node: str
) -> tuple[np.ndarray, np.ndarray]:
    """Return the complex samples of words C[N-k] + j C[k]."""
    width, coefficients = formats.width, formats.factor_width
    factors, drop = phase_factors(re.shape[-1], True, coefficients), formats.factor_drop + formats.input_drop
    re, im = twiddle(re, im, factors, drop, width, monitor, node + ".phase")
    return fft(re, im, True, width, coefficients, monitor, node + ".fft")


def _rounded(x: np.ndarray, formats: Transform, monitor: Monitor | None, node: str) -> np.ndarray:
    signed = alternate_sign(x) if formats.alternate else x
    return round_saturate(signed, formats.output_drop, formats.output_width, monitor, node + ".output")


def latency(size: int, paths: int) -> int:
    """Return the latency of a transform: pairs, phase, FFT, sign and rounding."""
    return row_pairs_latency(size, paths) + TWIDDLE + fft_latency(size, paths) + SIGN


def parts(config: Sizes) -> Parts:
    """Return those of the words of the arithmetic, and of the stored words of the spectral solver; with row_pairs."""
    size, paths, found = config.columns, config.up_paths, Parts()
    widths, rows_at_once = [config.arithmetic_width, config.depth.width], 1
    if config.solver == "tridiagonal":
        widths, rows_at_once = widths[:1], 2
    for width in widths:
        beats, waits = size // paths, size // paths // 2 + 2
        found += [
            Words(paths * config.depth.width, work=1 / rows_at_once / paths),
            *delay_line(width, waits) * (2 * paths),
            *[Memory("row buffers", width, beats)] * (2 * paths),
            *[Multiplier(width, config.coefficient.width)] * (4 * paths),
            factors_rom(config, paths, size),
            *fft_parts(config, paths, True),
            *delay_line(1, latency(size, paths)),
        ]
    return found
