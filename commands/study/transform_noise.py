# SPDX-License-Identifier: Apache-2.0
"""Rounding noise of the transform cores over blocks of random words, as in IEEE 1180-1990.

Peak, mean square and mean error of each output word, in steps of that word, for several amplitudes and both signs. The
limits of the standard are for one 8 x 8 transform of 9-bit words. Noise spreads over all modes and uses little of the
range of each, so single modes at full amplitude are measured too.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from scipy.fft import dst, idst

from commands.common.tabular import Column
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson import spectral_solver
from tactile_depth.chip.poisson.transform.fft import halvings, twiddle_stages
from tactile_depth.chip.poisson.transform.orders import bit_reversed, makhoul
from tactile_depth.chip.poisson.transform.twiddle import coefficient_gain

BIAS = 5.0  # allowed distance of a mean error from zero, in standard errors
FEWEST = 32  # random blocks: fewer give no standard error


@dataclass(frozen=True)
class Compliance:
    """Errors of a transform core against double precision, in steps of its output word."""

    core: Annotated[str, Column("transform")]
    size: Annotated[int, Column("size")]
    input: Annotated[str, Column("input")]
    blocks: Annotated[int, Column("blocks", ",")]
    amplitude: Annotated[int, Column("amplitude", ",")]
    peak: Annotated[float, Column("peak error, codes", ".2f")]
    worst_mean_square: Annotated[float, Column("worst mean square", ".3f")]
    mean_square: Annotated[float, Column("mean square error", ".3f")]
    worst_mean: Annotated[float, Column("worst mean", ".4f")]
    mean: Annotated[float, Column("mean error", ".5f")]
    mean_in_standard_errors: Annotated[float, Column("in standard errors", ".2f")]
    saturations: Annotated[int, Column("clipped", ",")]
    zero_in_zero_out: Annotated[bool, Column("zero in, zero out", lambda zero: "yes" if zero else "NO")]


def transforms(config: Configuration) -> dict[str, tuple[Callable, Callable, int]]:
    """Return name to core (blocks, monitor), the same in double precision, and dimensions; natural order."""
    size = config.columns
    order = makhoul(size)
    place = size - 1 - bit_reversed(size)  # of the mode at each position of a burst
    gain = coefficient_gain(config.coefficient.width) ** (twiddle_stages(size) + 1)
    halved = 2.0 ** -halvings(size, inverse=False)
    into, out_of = config.row_forward, config.row_modes
    to_modes, from_modes = config.column_inverse, config.depth_modes
    last = config.depth

    def forward(blocks: np.ndarray, monitor: Monitor) -> np.ndarray:
        return spectral_solver.row_forward(blocks, config, monitor)[..., np.argsort(place)]

    def exact_forward(blocks: np.ndarray) -> np.ndarray:
        scale = gain * halved / 2 * 2.0 ** (out_of.fraction - into.fraction)
        return dst(blocks, type=2) * scale

    def inverse(modes: np.ndarray, monitor: Monitor) -> np.ndarray:
        return spectral_solver.row_inverse(modes[..., place], config, monitor)

    def exact_inverse(modes: np.ndarray) -> np.ndarray:
        return idst(modes, type=2) * (2 / halved * gain * 2.0 ** (last.fraction - from_modes.fraction))

    def forward_2d(blocks: np.ndarray, monitor: Monitor) -> np.ndarray:
        columns = forward(blocks, monitor).swapaxes(-1, -2)[..., order]
        return spectral_solver.column_forward(columns, config, monitor)[..., np.argsort(place)]

    def exact_forward_2d(blocks: np.ndarray) -> np.ndarray:
        scale = gain * halved / 2 * 2.0 ** (config.column_forward.fraction - out_of.fraction)
        return dst(exact_forward(blocks).swapaxes(-1, -2), type=2) * scale

    def inverse_2d(modes: np.ndarray, monitor: Monitor) -> np.ndarray:
        columns = spectral_solver.column_inverse(modes[..., place], config, monitor)[..., np.argsort(order)]
        return inverse(columns.swapaxes(-1, -2), monitor)

    def exact_inverse_2d(modes: np.ndarray) -> np.ndarray:
        scale = 2 / halved * gain * 2.0 ** (from_modes.fraction - to_modes.fraction)
        return exact_inverse((idst(modes, type=2) * scale).swapaxes(-1, -2))

    return {
        "dst_forward": (forward, exact_forward, 1),
        "dst_inverse": (inverse, exact_inverse, 1),
        "2-D forward": (forward_2d, exact_forward_2d, 2),
        "2-D inverse": (inverse_2d, exact_inverse_2d, 2),
    }


def _blocks(
    core: str, size: int, dimensions: int, config: Configuration, count: int
) -> Iterator[tuple[str, int, np.ndarray]]:
    """Return name, amplitude and blocks: noise of several amplitudes and both signs, single modes and single words.

    Full amplitude is the largest that slopes, or a depth within the range, can cause at the core.
    """
    shape = (size,) * dimensions
    inverse = "inverse" in core
    rng = np.random.default_rng(1180)
    n, k = np.arange(size), np.arange(1, size + 1)
    sines = np.sin(np.pi * np.outer(k, 2 * n + 1) / (2 * size))
    chosen = np.unique(np.concatenate((k[:4], k[size // 2 - 1 : size // 2 + 2], k[-4:]))) - 1
    if inverse:
        # Modes of depth fields at the limits of the range.
        depth = 2.0 ** (config.depth.width - 1) * config.deepest_px / config.depth_limit_px
        exact = transforms(config)[core][1]
        unit = np.zeros((1, *shape))
        unit[(0,) * (dimensions + 1)] = 1
        per_mode = float(np.abs(exact(unit)).max())  # depth of a single first mode of 1
        full = int(depth / per_mode)
        lone = np.zeros((len(chosen), *shape))
        for index, mode in enumerate(chosen):
            lone[(index,) + (mode,) * dimensions] = full
    else:
        full = int(2 * config.gradient_limit / config.gradient_lsb)  # for the divergence of single slopes
        waves = sines[chosen]
        lone = full * (waves if dimensions == 1 else waves[:, :, None] * waves[:, None, :])
    yield "lone modes", full, np.rint(np.concatenate((lone, -lone))).astype(np.int64)
    for share in (1, 16, 4096):
        for sign in (1, -1):
            # Noise spreads: its sum at one word of an inverse transform is far below that of a lone mode.
            amplitude = max(1, full // share // (size**dimensions if inverse else 1))
            noise = rng.integers(-amplitude, amplitude + 1, (count, *shape))
            yield f"noise {'+' if sign > 0 else '-'}", amplitude, sign * noise
    yield "noise + of 5 steps", 5, rng.integers(-5, 6, (count, *shape))


def compliance(config: Configuration, count: int) -> list[Compliance]:
    """Measure every transform core over `count` random blocks (2-D: count / 32, at least `FEWEST`)."""
    rows = []
    for core, (fixed, exact, dimensions) in transforms(config).items():
        size = config.columns
        zero = not np.any(fixed(np.zeros((1, *(size,) * dimensions), np.int64), Monitor()))
        drawn = count if dimensions == 1 else max(FEWEST, count // 32)
        for name, amplitude, blocks in _blocks(core, size, dimensions, config, drawn):
            monitor = Monitor()
            error = fixed(blocks, monitor) - exact(blocks.astype(float))
            square, mean = (error**2).mean(axis=0), error.mean(axis=0)
            drawn_as = (core, size, name, len(blocks), amplitude)
            squares = (float(square.max()), float(square.mean()))
            means = (float(np.abs(mean).max()), float(abs(mean.mean())), _standard_errors(error))
            peak, clips = float(np.abs(error).max()), monitor.saturations.total()
            rows.append(Compliance(*drawn_as, peak, *squares, *means, clips, zero))
    return rows


def _standard_errors(error: np.ndarray) -> float:
    """Return the distance of the mean error of blocks from zero in standard errors; a large one is a bias."""
    means = error.reshape(len(error), -1).mean(axis=1)
    spread = float(means.std(ddof=1)) / np.sqrt(len(means))
    return float(abs(means.mean())) / spread if spread else 0.0
