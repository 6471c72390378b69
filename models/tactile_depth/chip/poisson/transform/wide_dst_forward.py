# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/wide_dst_forward.sv: dst_forward with several words per cycle."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.transform.dst_forward import dst_forward
from tactile_depth.chip.poisson.transform.transform import Transform
from tactile_depth.chip.poisson.transform.wide_commutator import from_beats, to_beats
from tactile_depth.chip.poisson.transform.wide_fft import latency as wide_fft_latency
from tactile_depth.chip.poisson.transform.wide_fft import parts as fft_parts
from tactile_depth.chip.poisson.transform.wide_twiddle import LATENCY as WIDE_TWIDDLE
from tactile_depth.chip.poisson.transform.wide_twiddle import factors_rom
from tactile_depth.chip.resources import Parts, Words, products

SIGN = 1


def wide_dst_forward(
    beats: np.ndarray, formats: Transform, monitor: Monitor | None = None, node: str = "dst_forward"
) -> np.ndarray:
    """Transform beats (..., beats, words), in the order of the core: the codes are those of dst_forward."""
    count, words = beats.shape[-2:]
    rows = from_beats(beats, count.bit_length() - 1)
    return to_beats(dst_forward(rows, formats, monitor, node), words, 0)


def latency(size: int, words: int) -> int:
    """Return the latency of a transform: sign, FFT, phase."""
    return SIGN + wide_fft_latency(size, words) + WIDE_TWIDDLE


def parts(config: Configuration) -> Parts:
    down = config.down_words
    return [
        Words(down * config.depth.width),
        *fft_parts(config, down, False),
        *products(config, 2 * down),
        factors_rom(config, down),
    ]
