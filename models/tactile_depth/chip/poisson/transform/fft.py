# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/fft.sv: radix-2^2 FFT, with the same codes for every number of paths.

S. He, M. Torkelson, A new approach to pipeline FFT processor, IPPS 1996.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.commutator import positions
from tactile_depth.chip.poisson.transform.sdf_butterfly import LATENCY as BUTTERFLY
from tactile_depth.chip.poisson.transform.sdf_butterfly import Stage, sdf_butterfly
from tactile_depth.chip.poisson.transform.twiddle import LATENCY as TWIDDLE
from tactile_depth.chip.poisson.transform.twiddle import factors_rom, twiddle, twiddle_factors
from tactile_depth.chip.resources import Parts, Sizes, delay_line, products


@cache
def stages(size: int, inverse: bool) -> tuple[Stage, ...]:
    """Return the stages in stream order.

    The forward transform starts with the full block and takes natural order. The inverse is the same graph reversed
    and takes bit-reversed order. The second butterfly of each pair halves, which keeps the pair orthonormal. If
    log2(size) is odd, one butterfly remains. It halves only in the inverse, so that forward and inverse together are
    the identity.
    """
    chain = []
    block = size
    while block >= 4:
        pair = [Stage(block, delay=block // 2), Stage(block, delay=block // 4, rotate=True, halve=True)]
        if inverse:
            pair = [Stage(block, delay=block // 2, rotate=True, halve=True), Stage(block, delay=block // 4)]
        chain += pair
        if block > 4:
            chain.append(Stage(block))
        block //= 4
    if block == 2:
        chain.append(Stage(2, delay=1, halve=inverse))
    return tuple(chain[::-1] if inverse else chain)


def twiddle_stages(size: int) -> int:
    """Return the number of twiddle multiplications of an FFT of `size` points."""
    return sum(stage.delay == 0 for stage in stages(size, inverse=False))


def halvings(size: int, inverse: bool) -> int:
    """Return the number of halvings of an FFT of `size` points."""
    return sum(stage.halve for stage in stages(size, inverse))


def _position_major(x: np.ndarray) -> np.ndarray:
    """Return the same array with its last axis outermost in memory, which makes the stages faster."""
    return np.moveaxis(np.ascontiguousarray(np.moveaxis(x, -1, 0)), 0, -1)


def fft(
    re: np.ndarray,
    im: np.ndarray,
    inverse: bool,
    width: int,
    factor_width: int,
    monitor: Monitor | None = None,
    node: str = "fft",
) -> tuple[np.ndarray, np.ndarray]:
    """Transform bursts along the last axis.

    Parameters
    ----------
    re, im : int64 arrays (..., N)
        Forward: natural order. Inverse: bit-reversed order.
    width, factor_width : int
        Bits of a data word and of a twiddle factor.

    Returns
    -------
    re, im : int64 arrays (..., N)
        Forward: bit-reversed order. Inverse: natural order. The gain is
        2**-halvings (1 - 2**(1 - factor_width)) ** twiddle_stages, relative to the sum without a factor.
    """
    re, im = _position_major(re), _position_major(im)
    for index, stage in enumerate(stages(re.shape[-1], inverse)):
        name = f"{node}.stage{index}"
        if stage.delay:
            re, im = sdf_butterfly(re, im, stage, inverse, width, monitor, name)
        else:
            factors = twiddle_factors(stage.block, inverse, factor_width)
            re, im = twiddle(re, im, factors, factor_width - 1, width, monitor, name)
    return re, im


def twiddle_window(size: int, paths: int, block: int, inverse: bool) -> int:
    """Return the lowest bit of the position in the path number, in the twiddle multiplication of a block."""
    bits, path_bits = block.bit_length() - 1, paths.bit_length() - 1
    if paths == 2:
        return bits - 2
    if inverse:
        return max(0, bits - path_bits)
    return min(bits - 2, size.bit_length() - 1 - path_bits)


def path_factors(size: int, paths: int, block: int, inverse: bool, factor_width: int) -> np.ndarray:
    """Return the twiddle factors of a block for each beat and path, int64 (beats, paths, 2); of one path one block."""
    factors = twiddle_factors(block, inverse, factor_width)
    if paths == 1:
        return factors[:, None]
    return factors[positions(size, paths, twiddle_window(size, paths, block, inverse)) % block]


def constant_paths(size: int, paths: int, block: int, inverse: bool) -> int:
    """Return the number of paths whose twiddle factors of a block are 1 in every beat: they have no multipliers."""
    places = positions(size, paths, twiddle_window(size, paths, block, inverse)) % block
    ones = (places < block // 4) | (places % (block // 4) == 0)
    return int(ones.all(axis=0).sum())


def latency(size: int, paths: int) -> int:
    """Return the latency of an FFT; all delays add up to the beats of a burst less 1."""
    registers = (size.bit_length() - 1) * BUTTERFLY + twiddle_stages(size) * TWIDDLE
    return size // paths - 1 + registers


def parts(config: Sizes, paths: int, inverse: bool) -> Parts:
    """Return the delay lines, and the tables and products of the factors that are not 1 in every beat."""
    size, width = config.columns, config.arithmetic_width
    if paths == 1:  # the lines hold sums
        width += 1
    delays = [1 << bit for bit in range((size // paths).bit_length() - 1)]  # in each path
    found: Parts = [line for delay in delays * paths for line in delay_line(2 * width, delay)]
    for stage in stages(size, inverse):
        if not stage.delay:
            rotated = paths - constant_paths(size, paths, stage.block, inverse)
            found += [*products(config, 4 * rotated), factors_rom(config, paths, stage.block if paths == 1 else size)]
    return found
