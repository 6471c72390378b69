# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/sdf_fft.sv: radix-2^2 single-path delay feedback FFT.

S. He, M. Torkelson, A new approach to pipeline FFT processor, IPPS 1996.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.sdf_butterfly import LATENCY as BUTTERFLY
from tactile_depth.chip.poisson.transform.sdf_butterfly import Stage, sdf_butterfly
from tactile_depth.chip.poisson.transform.twiddle_multiply import LATENCY as TWIDDLE_MULTIPLY
from tactile_depth.chip.poisson.transform.twiddle_multiply import twiddle_factors, twiddle_multiply
from tactile_depth.chip.resources import Parts, Sizes, delay_line, products, rom


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


def sdf_fft(
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
            re, im = twiddle_multiply(re, im, factors, factor_width - 1, width, monitor, name)
    return re, im


def latency(size: int) -> int:
    """Return the latency of an FFT; the delay lines of all butterflies add up to size - 1."""
    return size - 1 + (size.bit_length() - 1) * BUTTERFLY + twiddle_stages(size) * TWIDDLE_MULTIPLY


def parts(config: Sizes, inverse: bool) -> Parts:
    """Return complex words in delays, {-Im, Im, Re} in tables, and the products of the twiddle factors."""
    found: Parts = []
    for stage in stages(config.columns, inverse):
        if stage.delay:
            found += delay_line(2 * (config.arithmetic_width + 1), stage.delay)
        else:
            found += [*products(config, 4), rom(3 * config.coefficient.width, stage.block)]
    return found
