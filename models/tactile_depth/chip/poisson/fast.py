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
from tactile_depth.chip.poisson.forward_elimination import coefficient_rows, stored
from tactile_depth.chip.poisson.thomas_table import thomas_table
from tactile_depth.chip.poisson.transform.orders import mirror, read_only
from tactile_depth.chip.poisson.transform.sdf_fft import stages
from tactile_depth.chip.poisson.transform.transform import Transform
from tactile_depth.chip.poisson.transform.twiddle_multiply import phase_factors, twiddle_factors

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
def _transform(
    x: np.ndarray,
    inverse: bool,
    alternate: bool,
    drops: tuple[int, int],
    formats: tuple[int, int, int],
    graph: Graph,
    phase: Graph,
    y: np.ndarray,
    counts: np.ndarray,
) -> None:
    """Transform bursts (.., N), as `dst_forward` or `dst_inverse`; `counts`: first step, the stages, last step."""
    (bursts, size), (first, last), (width, drop, output_width), (factors, partners) = x.shape, drops, formats, phase
    for start in range(0, bursts, BURSTS):
        there = min(BURSTS, bursts - start)
        re, im = np.empty((size, there), np.int64), np.zeros((size, there), np.int64)
        for p in range(size):
            c, s = factors[p]
            a, b, q = re[p], im[p], partners[p]
            if inverse:
                for i in range(there):
                    mode = x[start + i, p]
                    other = x[start + i, q] if p else 0
                    a[i], b[i] = other * c - mode * s, other * s + mode * c
                counts[0, 1] += _clip_all(b, first, width)
            else:
                for i in range(there):
                    a[i] = -x[start + i, p] if alternate and p >= size // 2 else x[start + i, p]
            counts[0, 0] += _clip_all(a, first, width)
        _fft(re, im, inverse, width, drop, graph, counts[1:])
        for p in range(size):
            c, s = factors[p]
            a, b = re[p], im[p]
            for i in range(there):
                if not inverse:
                    a[i] = a[i] * c - b[i] * s
                elif alternate and p >= size // 2:
                    a[i] = -a[i]
            counts[-1, 0] += _clip_all(a, last, output_width)
            y[start : start + there, p] = a


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
def _substitute(d: np.ndarray, coefficients: np.ndarray, lift: int, drop: int, width: int, z: np.ndarray) -> int:
    count = 0
    frames, rows, columns = d.shape
    state = np.zeros(columns, np.int64)
    for frame in range(frames):
        for row in range(rows):
            for k in range(columns):
                above = coefficients[row - 1, k] * state[k] if row else 0
                state[k] = (d[frame, row, k] << (lift + drop)) - above
            count += _clip_all(state, drop, width)
            z[frame, row] = state
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


def _dst(x: np.ndarray, formats: Transform, inverse: bool, monitor: Monitor | None, node: str) -> np.ndarray:
    size, drop, factor_width = x.shape[-1], formats.factor_drop, formats.factor_width
    graph, phase = _graph(size, inverse, factor_width), (phase_factors(size, inverse, factor_width), mirror(size))
    steps, drops = ["input", "phase"], (formats.input_drop, drop + formats.output_drop)
    if inverse:
        steps, drops = ["phase", "output"], (drop + formats.input_drop, formats.output_drop)
    steps[1:1] = [f"fft.stage{index}" for index in range(len(graph[0]))]
    bursts, counts = np.ascontiguousarray(x).reshape(-1, size), np.zeros((len(steps), 2), np.int64)
    y, widths = np.empty(bursts.shape, np.int64), (formats.width, drop, formats.output_width)
    _transform(bursts, inverse, formats.alternate, drops, widths, graph, phase, y, counts)
    if monitor is not None:
        for step, parts in zip(steps, counts.tolist(), strict=True):
            for part, count in zip((".re", ".im"), parts, strict=True):
                monitor.clipped(f"{node}.{step}{'' if step.endswith('put') else part}", count)
    return y.reshape(x.shape)


def dst_forward(
    x: np.ndarray, formats: Transform, monitor: Monitor | None = None, node: str = "dst_forward"
) -> np.ndarray:
    """Model poisson/transform/dst_forward.py."""
    return _dst(x, formats, False, monitor, node)


def dst_inverse(
    modes: np.ndarray, formats: Transform, monitor: Monitor | None = None, node: str = "dst_inverse"
) -> np.ndarray:
    """Model poisson/transform/dst_inverse.py."""
    return _dst(modes, formats, True, monitor, node)


def forward_elimination(f: np.ndarray, config: Configuration, monitor: Monitor | None = None) -> np.ndarray:
    """Model poisson/forward_elimination.py."""
    frames = np.ascontiguousarray(f).reshape(-1, *f.shape[-2:])
    d = np.empty_like(frames)
    coefficients = coefficient_rows(config, f.shape[-2])
    counts = _eliminate(frames, coefficients, config.coefficient.fraction, config.arithmetic_width, d)
    if monitor is not None:
        monitor.clipped("forward_elimination.difference", counts[0])
        monitor.clipped("forward_elimination.state", counts[1])
    return stored(d.reshape(f.shape), config, monitor)


def back_substitution(d: np.ndarray, config: Configuration, monitor: Monitor | None = None) -> np.ndarray:
    """Model poisson/back_substitution.py."""
    frames = np.ascontiguousarray(d).reshape(-1, *d.shape[-2:])
    z = np.empty_like(frames)
    coefficients = np.ascontiguousarray(thomas_table(config).rows(d.shape[-2] - 1)[::-1])
    lift = config.elimination.fraction - config.elimination_store.fraction
    count = _substitute(frames, coefficients, lift, config.coefficient.fraction, config.arithmetic_width, z)
    if monitor is not None:
        monitor.clipped("back_substitution", count)
    return z.reshape(d.shape)


def settled(ratios: np.ndarray, light: Light) -> np.ndarray:
    """Model `settled` of gradient/light_gains.py."""
    pictures = np.ascontiguousarray(ratios[..., :-1, :, :]).reshape(-1, light.pixels, 3)
    lsb = np.float32(2.0**-light.ratio_fraction)
    gains = np.array([_settle(picture, lsb, 2.0**-NEAR_LOG2, ROUNDS, SETTLED) for picture in pictures])
    return light.limited(np.rint(gains.reshape(*ratios.shape[:-3], 3) * light.unity).astype(np.int64))
