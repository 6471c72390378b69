# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/twiddle.sv, and the contents of its ROMs."""

from __future__ import annotations

from functools import cache

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor, round_saturate
from tactile_depth.chip.poisson.transform.orders import bit_reversed, read_only
from tactile_depth.chip.resources import BY_SIZE, Memory, Sizes, late_style, rom

LATENCY = 5


def coefficient(x: np.ndarray, factor_width: int) -> np.ndarray:
    """Return factors in [-1, 1] as signed words; 1 is 2**(w-1) - 1, so every product has the same gain 1 - 2**(1-w).

    This gain is common to all words of a stage and is compensated once (`Configuration.transform_gain`).
    """
    return np.rint(np.asarray(x) * (2 ** (factor_width - 1) - 1)).astype(np.int64)


def coefficient_gain(factor_width: int) -> float:
    """Return the gain of a multiplication by a `coefficient` of 1."""
    return 1 - 2.0 ** (1 - factor_width)


def _factors(angle: np.ndarray, factor_width: int) -> np.ndarray:
    return read_only(coefficient(np.stack((np.cos(angle), np.sin(angle)), axis=-1), factor_width))


@cache
def twiddle_factors(block: int, inverse: bool, factor_width: int) -> np.ndarray:
    """Return exp(-+2 pi j e / block) of each word of a block, int64 (block, 2); e is 0, 2n, n, 3n in its quarters."""
    n = np.arange(block // 4)
    exponent = np.concatenate((0 * n, 2 * n, n, 3 * n))
    return _factors(2 * np.pi * exponent / block * (1 if inverse else -1), factor_width)


@cache
def phase_factors(size: int, inverse: bool, factor_width: int) -> np.ndarray:
    """Return the phase factor of Makhoul's method for the mode k at each position of a burst, int64 (size, 2).

    Forward: exp(-j pi k / 2N). Inverse: exp(j pi k / 2N) / j, for words C[N-k] + j C[k].
    """
    angle = np.pi * bit_reversed(size) / (2 * size)
    return _factors(angle - np.pi / 2 if inverse else -angle, factor_width)


def twiddle(
    re: np.ndarray,
    im: np.ndarray,
    factors: np.ndarray,
    drop: int,
    width: int,
    monitor: Monitor | None = None,
    node: str = "twiddle",
    real_only: bool = False,
) -> tuple[np.ndarray, np.ndarray]:
    """Multiply each block of a stream (..., N) by `factors` (block, 2).

    Returns
    -------
    re, im : int64 arrays (..., N)
        Products without `drop` fraction bits, saturated to `width` bits; im is 0 with `real_only`.
    """
    w_re, w_im = (np.tile(factors[:, part], re.shape[-1] // len(factors)) for part in (0, 1))
    product = re * w_re
    product -= im * w_im
    out_re = round_saturate(product, drop, width, monitor, node + ".re")
    if real_only:
        return out_re, np.zeros_like(out_re)
    product = re * w_im
    product += im * w_re
    return out_re, round_saturate(product, drop, width, monitor, node + ".im")


def ones(factors: np.ndarray, factor_width: int) -> int:
    """Return a word with a bit for each path, 1 where the factor is 1 in every beat."""
    one = factors == (2 ** (factor_width - 1) - 1, 0)
    return sum(int(path) << index for index, path in enumerate(np.all(one, axis=(0, 2))))


def factors_rom(config: Sizes, paths: int, words: int) -> Memory:
    """Return the table of `words` factors, of several paths a block memory where the factors of one fill one."""
    width, beats = 3 * config.coefficient.width, words // paths
    return rom(width * paths, beats, BY_SIZE if paths == 1 else late_style(width * beats))
