# SPDX-License-Identifier: Apache-2.0
"""Compiled by numba (extra `fast`): the transforms, the two recursions and the light gains of single pictures.

Each function has the arguments of the model of its name, and returns its codes and its clip counts. A monitor receives
clip counts only.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import ParamSpec, TypeVar

import numpy as np
from numba import njit

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.light_gains import NEAR_LOG2, ROUNDS, SETTLED, STEP_SHARE, Light
from tactile_depth.chip.poisson.elimination import ahead, coefficient_rows
from tactile_depth.chip.poisson.thomas_table import ahead_rows
from tactile_depth.chip.poisson.transform.fft import stages
from tactile_depth.chip.poisson.transform.orders import mirror, read_only
from tactile_depth.chip.poisson.transform.transform import Transform
from tactile_depth.chip.poisson.transform.twiddle import phase_factors, twiddle_factors

BURSTS = 128  # bursts at most that are transformed side by side: words of one position are loops of that length
P = ParamSpec("P")
R = TypeVar("R")
Graph = tuple[np.ndarray, np.ndarray]


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a function on its first call; its code is kept in files for the calls of other processes."""
    return njit(cache=True, nogil=True)(function)


@compiled
def _rounded(x: int, drop: int) -> int:
    if drop > 0:
        return (x + ((x >> drop) & 1) + ((1 << (drop - 1)) - 1)) >> drop
    return x << -drop


@compiled
def _clip_all(x: np.ndarray, drop: int, width: int) -> int:
    """Round and clip words in place, and return how many were clipped."""
    limit, count = 1 << (width - 1), 0
    for i in range(len(x)):
        y = _rounded(x[i], drop)
        clipped = min(max(y, -limit), limit - 1)
        count += clipped != y
        x[i] = clipped
    return count


@compiled
def _fft(
    re: np.ndarray, im: np.ndarray, inverse: bool, width: int, drop: int, graph: Graph, counts: np.ndarray
) -> None:
    """Transform bursts, (N, bursts) in stream order down the rows, in place; for `graph` see `_graph`."""
    size, (table, factors) = len(re), graph
    for index in range(len(table)):
        block, delay, rotate, halve, first = table[index]
        if delay == 0:
            for p in range(size):
                c, s = factors[first + p % block]
                a, b = re[p], im[p]
                for i in range(len(a)):
                    a[i], b[i] = a[i] * c - b[i] * s, a[i] * s + b[i] * c
                counts[index, 0] += _clip_all(a, drop, width)
                counts[index, 1] += _clip_all(b, drop, width)
            continue
        for p in range(size):
            if p & delay:
                continue
            a, b, c, d = re[p], im[p], re[p + delay], im[p + delay]
            if rotate and (p + delay) % block >= 3 * block // 4:
                for i in range(len(a)):
                    c[i], d[i] = (-d[i], c[i]) if inverse else (d[i], -c[i])
            for i in range(len(a)):
                a[i], c[i] = a[i] + c[i], a[i] - c[i]
                b[i], d[i] = b[i] + d[i], b[i] - d[i]
            counts[index, 0] += _clip_all(a, halve, width) + _clip_all(c, halve, width)
            counts[index, 1] += _clip_all(b, halve, width) + _clip_all(d, halve, width)


@cache
def _graph(size: int, inverse: bool, factor_width: int) -> Graph:
    """Return the stages of an FFT, int64 (stages, 5): the fields of `Stage`, first factor; and all factors (.., 2)."""
    table, factors = [], [np.zeros((0, 2), np.int64)]
    for stage in stages(size, inverse):
        table.append((stage.block, stage.delay, stage.rotate, stage.halve, sum(map(len, factors))))
        if not stage.delay:
            factors.append(twiddle_factors(stage.block, inverse, factor_width))
    return read_only(np.array(table, np.int64)), read_only(np.concatenate(factors))


@compiled
def _forward(
    x: np.ndarray,
    alternate: bool,
    drops: tuple[int, int],
    formats: tuple[int, int, int],
    graph: Graph,
    factors: np.ndarray,
    y: np.ndarray,
    counts: np.ndarray,
) -> None:
    """Transform bursts (.., N), as `dst_forward`; `counts`: first step, the stages, last step."""
    (bursts, size), (first, last), (width, drop, output_width) = x.shape, drops, formats
    for start in range(0, bursts, BURSTS):
        there = min(BURSTS, bursts - start)
        re, im = np.empty((size, there), np.int64), np.zeros((size, there), np.int64)
        for p in range(size):
            a = re[p]
            for i in range(there):
                a[i] = -x[start + i, p] if alternate and p >= size // 2 else x[start + i, p]
            counts[0, 0] += _clip_all(a, first, width)
        _fft(re, im, False, width, drop, graph, counts[1:])
        for p in range(size):
            c, s = factors[p]
            a, b = re[p], im[p]
            for i in range(there):
                a[i] = a[i] * c - b[i] * s
            counts[-1, 0] += _clip_all(a, last, output_width)
            y[start : start + there, p] = a


@compiled
def _inverse(
    x: np.ndarray,
    lone: np.ndarray,
    alternate: bool,
    drops: tuple[int, int],
    formats: tuple[int, int, int, int],
    graph: Graph,
    phase: Graph,
    y: np.ndarray,
    counts: np.ndarray,
) -> None:
    """Transform pairs of bursts (.., 2, N), as `dst_inverse_pairs`, of which the second one of `lone` pairs is 0.

    `counts`: the sums of the two, first step, the stages, last step.
    """
    (pairs, _, size), (first, last), (factors, partners) = x.shape, drops, phase
    pair_width, width, drop, output_width = formats
    for start in range(0, pairs, BURSTS):
        there = min(BURSTS, pairs - start)
        re, im = np.empty((size, there), np.int64), np.empty((size, there), np.int64)
        for p in range(size):
            a, b, q = re[p], im[p], partners[p]
            for i in range(there):
                pair = x[start + i]
                a[i], b[i] = (pair[0, q] if p else 0) - pair[1, p], pair[0, p] + (pair[1, q] if p else 0)
            counts[0, 0] += _clip_all(a, 0, pair_width)
            counts[0, 1] += _clip_all(b, 0, pair_width)
            c, s = factors[p]
            for i in range(there):
                a[i], b[i] = a[i] * c - b[i] * s, a[i] * s + b[i] * c
            counts[1, 0] += _clip_all(a, first, width)
            counts[1, 1] += _clip_all(b, first, width)
        _fft(re, im, True, width, drop, graph, counts[2:])
        for p in range(size):
            a, b = re[p], im[p]
            sign = -1 if alternate and p >= size // 2 else 1
            for i in range(there):
                a[i], b[i] = sign * a[i], 0 if lone[start + i] else sign * b[i]
            counts[-1, 0] += _clip_all(a, last, output_width) + _clip_all(b, last, output_width)
            for i in range(there):
                y[start + i, 0, p], y[start + i, 1, p] = a[i], b[i]


@compiled
def _eliminate(f: np.ndarray, coefficients: np.ndarray, drop: int, width: int, d: np.ndarray) -> tuple[int, int]:
    differences, states = 0, 0
    frames, rows, columns = f.shape
    state = np.zeros(columns, np.int64)
    for frame in range(frames):
        state[:] = 0
        for row in range(rows):
            for k in range(columns):
                state[k] = f[frame, row, k] - state[k]
            differences += _clip_all(state, 0, width)
            for k in range(columns):
                state[k] *= coefficients[row, k]
            states += _clip_all(state, drop, width)
            d[frame, row] = state
    return differences, states


@compiled
def _substitute(e: np.ndarray, coefficients: np.ndarray, lift: int, drop: int, width: int, z: np.ndarray) -> int:
    count = 0
    frames, rows, columns = e.shape
    for frame in range(frames):
        for row in range(rows):
            state = z[frame, row]
            for k in range(columns):
                below = coefficients[row - 2, k] * z[frame, row - 2, k] if row >= 2 else 0
                state[k] = (e[frame, row, k] << (lift + drop)) - below
            count += _clip_all(state, drop, width)
    return count


@compiled
def _settle(ratios: np.ndarray, lsb: np.float32, limit: float, rounds: int, enough: float) -> np.ndarray:
    """Return the gains of a picture; sums of deviations, multiples of 2**-24, are exact in any order."""
    pixels, one = len(ratios), np.float32(1)
    gains, total, net = np.ones(3), np.zeros(3), np.zeros(3, np.int64)
    deviation = np.zeros(3, np.float32)
    for _ in range(rounds):
        total[:] = 0
        net[:] = 0
        count, change = 0, 0.0
        for pixel in range(pixels):
            near = True
            for colour in range(3):
                value = np.float32(ratios[pixel, colour]) * lsb * np.float32(gains[colour]) - one
                deviation[colour] = value
            if not (ratios[pixel, 0] or ratios[pixel, 1] or ratios[pixel, 2]):
                count += 1
                continue
            for colour in range(3):
                above, below = deviation[colour] >= limit, deviation[colour] <= -limit
                net[colour] += np.int64(above) - np.int64(below)
                near &= not (above or below)
            if near:
                count += 1
                for colour in range(3):
                    total[colour] += deviation[colour]
        for colour in range(3):
            before, after = gains[colour], gains[colour]
            if abs(net[colour]) >= STEP_SHARE * pixels:
                after = before - limit * np.sign(net[colour])
            elif 4 * count >= pixels:
                after = before / (1 + total[colour] / count)
            gains[colour] = min(max(after, 0.5), 2.0)
            change = max(change, abs(gains[colour] - before))
        if change < enough:
            break
    return gains


# The models.


def _told(monitor: Monitor | None, node: str, steps: list[str], counts: np.ndarray) -> None:
    if monitor is not None:
        for step, parts in zip(steps, counts.tolist(), strict=True):
            for part, count in zip((".re", ".im"), parts, strict=True):
                monitor.clipped(f"{node}.{step}{'' if step.endswith('put') else part}", count)


def _stages(graph: Graph) -> list[str]:
    return [f"fft.stage{index}" for index in range(len(graph[0]))]


def dst_forward(
    x: np.ndarray, formats: Transform, monitor: Monitor | None = None, node: str = "dst_forward"
) -> np.ndarray:
    """Model poisson/transform/dst_forward.py."""
    size, drop, factor_width = x.shape[-1], formats.factor_drop, formats.factor_width
    graph, factors = _graph(size, False, factor_width), phase_factors(size, False, factor_width)
    steps, drops = ["input", *_stages(graph), "phase"], (formats.input_drop, drop + formats.output_drop)
    bursts, counts = np.ascontiguousarray(x).reshape(-1, size), np.zeros((len(steps), 2), np.int64)
    y, widths = np.empty(bursts.shape, np.int64), (formats.width, drop, formats.output_width)
    _forward(bursts, formats.alternate, drops, widths, graph, factors, y, counts)
    _told(monitor, node, steps, counts)
    return y.reshape(x.shape)


def dst_inverse(
    modes: np.ndarray, formats: Transform, monitor: Monitor | None = None, node: str = "dst_inverse"
) -> np.ndarray:
    """Model poisson/transform/dst_inverse.py; no word is clipped to 63 bits."""
    return _inverse_rows(modes[..., None, :], 63, formats, monitor, node)[..., 0, :]


def dst_inverse_pairs(
    modes: np.ndarray, formats: Transform, monitor: Monitor | None = None, node: str = "dst_inverse"
) -> np.ndarray:
    """Model `dst_inverse_pairs` of poisson/transform/dst_inverse.py."""
    return _inverse_rows(modes, formats.width, formats, monitor, node)


def _inverse_rows(
    modes: np.ndarray, pair_width: int, formats: Transform, monitor: Monitor | None, node: str
) -> np.ndarray:
    *frames, rows, size = modes.shape
    drop, factor_width = formats.factor_drop, formats.factor_width
    pairs = np.zeros((*frames, rows + rows % 2, size), np.int64)
    pairs[..., :rows, :] = modes
    lone = np.zeros((*frames, pairs.shape[-2] // 2), bool)
    lone[..., -1] = rows % 2
    graph, phase = _graph(size, True, factor_width), (phase_factors(size, True, factor_width), mirror(size))
    steps, drops = ["pair", "phase", *_stages(graph), "output"], (drop + formats.input_drop, formats.output_drop)
    y, counts = np.empty_like(pairs), np.zeros((len(steps), 2), np.int64)
    widths, shape = (pair_width, formats.width, drop, formats.output_width), (-1, 2, size)
    x, of_rows = pairs.reshape(shape), y.reshape(shape)
    _inverse(x, lone.ravel(), formats.alternate, drops, widths, graph, phase, of_rows, counts)
    _told(monitor, node, steps, counts)
    return y[..., :rows, :]


def elimination(f: np.ndarray, config: Configuration, monitor: Monitor | None = None) -> np.ndarray:
    """Model poisson/elimination.py."""
    frames = np.ascontiguousarray(f).reshape(-1, *f.shape[-2:])
    d = np.empty_like(frames)
    coefficients = coefficient_rows(config, f.shape[-2])
    counts = _eliminate(frames, coefficients, config.coefficient.fraction, config.arithmetic_width, d)
    if monitor is not None:
        monitor.clipped("elimination.difference", counts[0])
        monitor.clipped("elimination.state", counts[1])
    return ahead(d.reshape(f.shape), config, monitor)


def substitution(e: np.ndarray, config: Configuration, monitor: Monitor | None = None) -> np.ndarray:
    """Model poisson/substitution.py."""
    frames = np.ascontiguousarray(e).reshape(-1, *e.shape[-2:])
    z = np.empty_like(frames)
    coefficients = np.ascontiguousarray(ahead_rows(config)[::-1])
    lift = config.elimination.fraction - config.elimination_store.fraction
    count = _substitute(frames, coefficients, lift, config.coefficient.fraction, config.arithmetic_width, z)
    if monitor is not None:
        monitor.clipped("substitution", count)
    return z.reshape(e.shape)


def settled(ratios: np.ndarray, light: Light) -> np.ndarray:
    """Model `settled` of gradient/light_gains.py."""
    pictures = np.ascontiguousarray(ratios[..., :-1, :, :]).reshape(-1, light.pixels, 3)
    lsb = np.float32(2.0**-light.ratio_fraction)
    gains = np.array([_settle(picture, lsb, 2.0**-NEAR_LOG2, ROUNDS, SETTLED) for picture in pictures])
    return light.limited(np.rint(gains.reshape(*ratios.shape[:-3], 3) * light.unity).astype(np.int64))
