# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/wide_dst_inverse.sv: two rows in one complex transform."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor, round_saturate
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.transform.dst_forward import SIGN, alternate_sign
from tactile_depth.chip.poisson.transform.sdf_fft import sdf_fft
from tactile_depth.chip.poisson.transform.transform import Transform
from tactile_depth.chip.poisson.transform.twiddle_multiply import phase_factors, twiddle_multiply
from tactile_depth.chip.poisson.transform.wide_corner_turn import latency as wide_corner_turn_latency
from tactile_depth.chip.poisson.transform.wide_fft import latency as wide_fft_latency
from tactile_depth.chip.poisson.transform.wide_fft import parts as fft_parts
from tactile_depth.chip.poisson.transform.wide_row_pairs import latency as wide_row_pairs_latency
from tactile_depth.chip.poisson.transform.wide_row_pairs import wide_row_pairs
from tactile_depth.chip.poisson.transform.wide_twiddle import LATENCY as WIDE_TWIDDLE
from tactile_depth.chip.poisson.transform.wide_twiddle import factors_rom
from tactile_depth.chip.resources import Memory, Parts, Words, delay_line, products


def wide_dst_inverse(
    modes: np.ndarray, formats: Transform, monitor: Monitor | None = None, node: str = "wide_dst_inverse"
) -> np.ndarray:
    """Compute the inverse DST-II of rows, two in one complex FFT: one as its real part, the next as its imaginary part.

    With modes a and b of the two rows, C[N-k] + j C[k] of both together is (a[N-k] - b[k]) + j (a[k] + b[N-k]).

    Parameters
    ----------
    modes : int64 array (..., rows, N), words of `width` bits in bit-reversed order
        Rows in the order in which they enter, the first and the second as a pair. An odd last row has zeros beside it.

    Returns
    -------
    int64 array (..., rows, N), Makhoul order, as `dst_inverse`
    """
    rows, size = modes.shape[-2:]
    first, second = modes[..., 0::2, :], modes[..., 1::2, :]
    if rows % 2:
        second = np.concatenate((second, np.zeros_like(first[..., -1:, :])), axis=-2)
    width, coefficients = formats.width, formats.factor_width
    re, im = wide_row_pairs(first, second, width, monitor, node + ".pair")
    factors, drop = phase_factors(size, True, coefficients), formats.factor_drop + formats.input_drop
    re, im = twiddle_multiply(re, im, factors, drop, width, monitor, node + ".phase")
    parts = np.stack(sdf_fft(re, im, True, width, coefficients, monitor, node + ".fft"), axis=-2)
    pairs = alternate_sign(parts) if formats.alternate else parts
    samples = pairs.reshape(*modes.shape[:-2], -1, size)[..., :rows, :]
    return round_saturate(samples, formats.output_drop, formats.output_width, monitor, node + ".output")


def latency(size: int, words: int) -> int:
    """Return the cycles from a start, 2 before its words, to the first words of the first row out.

    Pairs, phase, FFT, sign and rounding, corner turn.
    """
    paths = words // 2
    rotated = wide_row_pairs_latency(size, paths) + WIDE_TWIDDLE
    return rotated + wide_fft_latency(size, paths) + SIGN + wide_corner_turn_latency(size, paths)


def parts(config: Configuration) -> Parts:
    """Return those of the core with its pairs of rows and its corner turn."""
    size, data, width, paths = config.columns, config.depth.width, config.arithmetic_width, config.lanes // 2
    beats = size // paths
    half = beats // 2
    turned = Memory("row buffers", data, 2 * half if paths == 1 else 2 * beats)
    turn = latency(size, config.lanes) - wide_corner_turn_latency(size, paths)
    return [
        Words(paths * data),
        *delay_line(width, half) * (2 * paths),
        *[Memory("row buffers", 2 * width, half)] * (2 * paths),
        *products(config, 4 * paths),
        factors_rom(config, paths),
        *fft_parts(config, paths, True),
        *delay_line(1, turn),
        *[turned] * (4 if paths == 1 else 2 * paths),
    ]
