# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/wide_fft.sv: sdf_fft with several words per cycle, and its ROMs."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.transform.sdf_fft import latency as sdf_fft_latency
from tactile_depth.chip.poisson.transform.sdf_fft import parts as sdf_fft_parts
from tactile_depth.chip.poisson.transform.sdf_fft import sdf_fft, stages, twiddle_stages
from tactile_depth.chip.poisson.transform.twiddle_multiply import twiddle_factors
from tactile_depth.chip.poisson.transform.wide_butterfly import LATENCY as BUTTERFLY
from tactile_depth.chip.poisson.transform.wide_commutator import LEAD, from_beats, positions, to_beats
from tactile_depth.chip.poisson.transform.wide_twiddle import LATENCY as WIDE_TWIDDLE
from tactile_depth.chip.poisson.transform.wide_twiddle import factors_rom
from tactile_depth.chip.resources import Parts, delay_line, products


def wide_fft(
    re: np.ndarray,
    im: np.ndarray,
    inverse: bool,
    width: int,
    factor_width: int,
    monitor: Monitor | None = None,
    node: str = "fft",
) -> tuple[np.ndarray, np.ndarray]:
    """Transform beats (..., beats, paths), in the order of the core: the codes are those of sdf_fft."""
    beats, paths = re.shape[-2:]
    high, low = beats.bit_length() - 1, 0
    before, behind = (low, high) if inverse else (high, low)
    re, im = from_beats(re, before), from_beats(im, before)
    out_re, out_im = sdf_fft(re, im, inverse, width, factor_width, monitor, node)
    return to_beats(out_re, paths, behind), to_beats(out_im, paths, behind)


def twiddle_window(size: int, paths: int, block: int, inverse: bool) -> int:
    """Return the lowest bit of the position in the path number, in the twiddle multiplication of a block."""
    bits, path_bits = block.bit_length() - 1, paths.bit_length() - 1
    if paths == 2:
        return bits - 2
    if inverse:
        return max(0, bits - path_bits)
    return min(bits - 2, size.bit_length() - 1 - path_bits)


def wide_factors(size: int, paths: int, block: int, inverse: bool, factor_width: int) -> np.ndarray:
    """Return the twiddle factors of a block for each beat and path, int64 (beats, paths, 2)."""
    window = twiddle_window(size, paths, block, inverse)
    return twiddle_factors(block, inverse, factor_width)[positions(size, paths, window) % block]


def constant_paths(size: int, paths: int, block: int, inverse: bool) -> int:
    """Return the number of paths whose twiddle factors of a block are 1 in every beat: they have no multipliers."""
    places = positions(size, paths, twiddle_window(size, paths, block, inverse)) % block
    ones = (places < block // 4) | (places % (block // 4) == 0)
    return int(ones.all(axis=0).sum())


def latency(size: int, paths: int) -> int:
    """Return the latency of an FFT; the delays of all commutators add up to the beats of a burst less 1."""
    if paths == 1:
        return LEAD + sdf_fft_latency(size)
    stages = (size.bit_length() - 1) * BUTTERFLY + twiddle_stages(size) * WIDE_TWIDDLE
    return size // paths - 1 + stages


def parts(config: Configuration, paths: int, inverse: bool) -> Parts:
    """Return a line for each path in each commutator, and the products by factors that are not 1 in every beat."""
    if paths == 1:
        return sdf_fft_parts(config, inverse)
    size = config.columns
    delays = [1 << bit for bit in range((size // paths).bit_length() - 1)]
    lines = [line for delay in delays for line in delay_line(2 * config.arithmetic_width, delay)]
    found: Parts = [*lines * paths]
    for stage in stages(size, inverse):
        if not stage.delay:
            rotated = paths - constant_paths(size, paths, stage.block, inverse)
            found += [*products(config, 4 * rotated), factors_rom(config, paths)]
    return found
