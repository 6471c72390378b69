# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/self_check.sv: how far depths are from solving their equation.

The check is Freivalds's: an equation of whole rows is multiplied by a pattern of signs, from left, on both sides
(Freivalds, Probabilistic machines can use less running time, IFIP 1977; Huang and Abraham, IEEE Trans. Computers 33(6),
1984). What remains is rounding if every bit of the solver was right.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.latency import frame_latency
from tactile_depth.chip.poisson import spectral_solver, tridiagonal_solver
from tactile_depth.chip.poisson.cores import NUMPY
from tactile_depth.chip.poisson.divergence import divergence
from tactile_depth.chip.poisson.divergence_sums import SUMS, begin, divergence_sums, sums
from tactile_depth.chip.resources import BLOCK, Memory, Parts, Words

MARGIN = 1.3  # bound over the largest residual of `extreme_slopes`, at least
SIGMAS = 6.0  # bound over the RMS of the residuals of noise, at least: 2e-9 of them are beyond, if they are normal
NOISE_FRAMES = 4  # the last ones of `extreme_slopes`
KEPT_LOG2 = 7  # bits of that residual which stay when low bits of a depth are dropped
EXACT_WIDTH = 62  # of sums that do not wrap
LESS_LOG2 = np.array([2, 0, 0, 1])  # of each pattern 1 / 2**LESS_LOG2 counts, so that it does not set the bound alone
WRAP_LOG2 = 3  # a sum wraps at this many bits above the bound


@dataclass(frozen=True)
class Check:
    """Numbers of a check, parameters of hdl/poisson/self_check.sv.

    Attributes
    ----------
    neumann : bool
    dropped, in_dropped : int
        Low bits that a depth and a divergence lose before they are added up.
    scale, scale_fraction : int
        A divergence is scale * 2**-scale_fraction of the unit of a depth, both without their dropped bits.
    sum_width : int
        Bits of the sums, which wrap.
    bound : int
        Largest residual of a frame that counts as right.
    """

    neumann: bool
    dropped: int
    in_dropped: int
    scale: int
    scale_fraction: int
    sum_width: int
    bound: int


def residuals(f: np.ndarray, z: np.ndarray, check: Check) -> np.ndarray:
    """Return what divergence codes and depth codes, int64 (..., rows, columns), leave of each row's equation.

    The first pattern is all ones; it and the last one count for less. Rows in raster order. Rows and columns beyond
    the edges are equal to the outer ones (Neumann) or minus them; minus x is here its complement, -x - 1, which costs
    no adder.

    Returns
    -------
    int64 array (..., rows, patterns), signed numbers of `sum_width` bits
    """
    kept = z >> check.dropped
    parts = sums(z.shape[-1]).T
    r = kept @ parts + begin(z.shape[-1], check.dropped)
    left = kept[..., :1] if check.neumann else ~kept[..., :1]
    s = np.diff(np.concatenate((left, kept), axis=-1), 2, axis=-1) @ parts[:-1]
    first, last = (r[..., :1, :], r[..., -1:, :]) if check.neumann else (~r[..., :1, :], ~r[..., -1:, :])
    bend = np.diff(np.concatenate((first, r, last), axis=-2), 2, axis=-2)
    rest = bend + s - divergence_sums(f, check.in_dropped, check.scale, check.scale_fraction)
    total = rest[..., :1]
    of_signs = wrapped(total - 2 * rest[..., 1:], check.sum_width)
    return np.concatenate((wrapped(total, check.sum_width), of_signs), axis=-1) >> LESS_LOG2


def wrapped(words: np.ndarray, width: int) -> np.ndarray:
    """Return words modulo 2**width as signed numbers."""
    half = 1 << (width - 1)
    return ((words + half) & (2 * half - 1)) - half


def self_check(f: np.ndarray, z: np.ndarray, check: Check) -> np.ndarray:
    """Return the largest residual of each frame, int64 (...); a negative one counts as its complement.

    Parameters
    ----------
    f, z : int64 arrays (..., rows, columns), codes of `config.divergence` and of `config.depth`, rows in raster order
    """
    left = residuals(f, z, check)
    return np.where(left < 0, ~left, left).max(axis=(-2, -1))


def latency(lanes: int) -> int:
    """Return the cycles with en from the last beat of a frame to its verdict."""
    return 18 + lanes.bit_length() - 1


@lru_cache(maxsize=64)
def check_of(config: Configuration) -> Check:
    """Return the numbers of a configuration's check.

    The bound is `MARGIN` times the largest residual of `extreme_slopes`, none of which clips, and at least `SIGMAS`
    times the RMS of noise, whose largest residual grows with the number of frames: half a second on the models, the
    same result each time.
    """
    f, z = extreme_frames(config)
    exact = replace(without_bound(config, 0), sum_width=EXACT_WIDTH)
    largest = int(self_check(f, z, exact).max())
    check = without_bound(config, max(exact.dropped, largest.bit_length() - 1 - KEPT_LOG2))
    left = residuals(f, z, replace(check, sum_width=EXACT_WIDTH))
    rms = np.sqrt((left[-NOISE_FRAMES:] ** 2.0).mean(axis=(0, 1))).max()
    bound = math.ceil(max(MARGIN * int(np.abs(left).max()), SIGMAS * rms))
    widest = max(config.depth.width - check.dropped, config.divergence.width - check.in_dropped)
    # No two words that are wrong by the same power of two, their highest bit, are lost.
    return replace(check, bound=bound, sum_width=max(widest + 1, bound.bit_length() + WRAP_LOG2))


def without_bound(config: Configuration, dropped: int) -> Check:
    """Return the numbers of a check that drops that many bits of a depth, or as many as the scale needs."""
    scale = config.gradient_lsb / config.depth_lsb_px
    fraction = min(config.depth.width, config.columns // SUMS - 1)
    above = math.floor(math.log2(scale)) + 1  # the scale is a mantissa of 1/2 to 1 times 2**above
    code = round(scale * 2.0 ** (fraction - above))
    if code == 1 << fraction:
        code, above = code // 2, above + 1
    dropped = max(dropped, above)
    return Check(config.neumann, dropped, dropped - above, code, fraction, 0, 0)


def depth_words(rows: int, columns: int, lanes: int, bottom_first: bool, frame_latency: int) -> int:
    """Return the words of the memory: those of all rows that come while a row waits for its depths."""
    leave = -(-rows // lanes) if bottom_first else 1
    held = rows + leave + -(-frame_latency // columns) + 3
    return 1 << (SUMS * held - 1).bit_length()


def parts(config: Configuration) -> Parts:
    """Return the sums of frames, and the memory that they wait in."""
    held = depth_words(config.rows, config.columns, config.lanes, config.solver == "tridiagonal", frame_latency(config))
    width = check_of(config).sum_width
    return [Words(width), Memory("row buffers", width, held, BLOCK)]


# The frames behind the bound.


def extreme_slopes(rows: int, columns: int) -> np.ndarray:
    """Return slopes of -1 to 1 at the edges of the input range, float64 (frames, rows, columns, 2).

    Contacts in the middle, at the edge, in a corner, and several; a cone that fills the frame; constant slopes; a
    chequer board; noise; no contact.
    """
    size = min(rows, columns)
    y, x = np.indices((rows, columns)) + 0.5

    def of(height: np.ndarray) -> np.ndarray:
        steps = [np.diff(height, axis=axis, append=np.take(height, [-1], axis)) for axis in (1, 0)]
        return np.clip(np.stack(steps, axis=-1), -1, 1)

    def ball(row: float, column: float, radius: float) -> np.ndarray:
        from_centre = np.hypot(y - row * rows, x - column * columns)
        return np.sqrt(np.maximum((radius * size) ** 2 - from_centre**2, 0))

    several = of(sum((ball(*at, 0.12) for at in ((0.2, 0.3), (0.5, 0.7), (0.8, 0.2), (0.7, 0.8))), np.zeros_like(x)))
    middle = of(ball(0.5, 0.5, 0.4))
    cone = of(np.maximum(size / 2 - 1 - np.hypot(y - rows / 2, x - columns / 2), 0))
    flat = np.ones((rows, columns, 2))
    board = flat * np.where((x + y) % 2 < 1, 1, -1)[..., None]
    noise = np.random.default_rng(1).uniform(-1, 1, (NOISE_FRAMES, rows, columns, 2))
    contacts = [middle, of(ball(0.5, 1.0, 0.4)), of(ball(0.0, 1.0, 0.4)), several, 0.3 * several, 0.3 * middle, cone]
    return np.stack([*contacts, flat, -flat, flat * (0.5, 0.25), board, 0 * flat, *noise])


def extreme_frames(config: Configuration) -> tuple[np.ndarray, np.ndarray]:
    """Return divergence and depth of `extreme_slopes`, rows in raster order, int64 (frames, rows, columns) each.

    Slopes whose depth clips are made smaller until it does not.
    """
    tridiagonal = config.solver == "tridiagonal"
    solve = tridiagonal_solver.tridiagonal_solver if tridiagonal else spectral_solver.spectral_solver
    largest = (1 << (config.gradient.width - 1)) - 1
    pairs = []
    for slopes in extreme_slopes(config.rows, config.columns):
        steepest = config.gradient_limit / config.gradient_lsb
        while True:
            codes = np.clip(np.rint(slopes * steepest), -largest, largest).astype(np.int64)
            f = divergence(codes, config.neumann)
            monitor = Monitor()
            z = solve(f[None], config, monitor, NUMPY)[0]
            if not any(monitor.saturations.values()):
                break
            steepest *= 0.7
        pairs.append((f, z[::-1] if tridiagonal else z))
    f_frames, z_frames = zip(*pairs, strict=True)
    return np.stack(f_frames), np.stack(z_frames)
