# SPDX-License-Identifier: Apache-2.0
"""`make sweep`: accuracy against latency, multipliers and memory, by the bit-accurate models, into one CSV.

Takes OUT=folder and DASK_SCHEDULER=host:port. Each row is written to the disk before the next begins, so an interrupted
sweep continues where it stopped. Errors are taken against double precision and against the height map that was drawn.
Exit status: 0 complete, 2 bad input, 130 interrupted.
"""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from commands.common import published
from commands.common.repository import ROOT
from commands.common.slopes import deepest
from commands.common.tabular import Table
from commands.common.variables import Name, Place
from commands.cost.cost import ECP5, cost
from commands.study import study
from commands.study.accuracy import errors
from commands.study.study import INTERRUPTED as INTERRUPTED
from commands.study.study import Study, built
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import COEFFICIENT, DEFAULTS, SOLVER_NUMBERS, STORED, WIDTHS, Configuration
from tactile_depth.chip.limits import COLUMNS, most_lanes
from tactile_depth.depth import reference
from tactile_depth.depth.twin import Twin
from tactile_depth.sensor.scenes import render, scene_pixel_pitch_mm
from tactile_depth.sensor.synthetic import synthetic

DEFAULT_OUT = ROOT / "build" / "sweep"
SCENE, SEED = "bench", 1  # the scene that a sweep measures, and the seed of its noise
SECONDS = 5e-6  # of a pixel
GRIDS = (32, 64, 128, 256, 512)
LANE_GRIDS = (128, 256)  # on both the tridiagonal solver can have the most lanes
WORST = "worst"  # depth range: the largest depth that any slopes can reach


@dataclass(frozen=True)
class Point(study.with_numbers(SOLVER_NUMBERS)):  # type: ignore[misc]
    """Configuration of a square grid."""

    depth_range: str  # `default` or WORST


@dataclass(frozen=True)
class Row(Point):
    """A configuration and its measurements over the contacts of the bench.

    `*_percent_*` is the error against double precision in % of its peak, mean and worst over the contacts. `true_*_mm`
    is the error against the height map that was drawn; it includes the error of the sensor.
    """

    problem: str
    depth_range_mm: float
    scene: str
    seed: int
    frames: int
    rms_percent_mean: float
    rms_percent_worst: float
    max_percent_mean: float
    max_percent_worst: float
    true_rms_mm_mean: float
    true_rms_mm_worst: float
    true_max_mm_worst: float
    saturations: int
    first_depth_cycles: int
    last_pixel_to_first_depth_cycles: int
    last_pixel_to_last_depth_cycles: int
    multipliers: int
    multipliers_18: int
    memory_bits: int
    frame_store_bits: int
    delay_line_bits: int
    table_bits: int
    row_buffer_bits: int
    models: str


_usual = Configuration()
DEFAULT = Point(
    *(_usual.solver, _usual.boundary, _usual.rows, _usual.columns, _usual.lanes),
    *(*(DEFAULTS[name] for name in SOLVER_NUMBERS), "default"),
)
SAFE_WORD = "DEPTH_RANGE=worst"
SAFE: dict[str, Any] = {"depth_range": WORST}
WORD = WIDTHS[STORED].variable


def square(columns: int = _usual.columns, **changes: Any) -> Point:
    """Return the default configuration with another grid and with changes."""
    point: Point = DEFAULT.but(rows=columns, columns=columns, **changes)
    return point


def plan() -> list[Point]:
    """Return every configuration of the sweep.

    The sweep varies grid, boundary and the two widths one at a time, then both widths together, the depth range that no
    slopes exceed (DEPTH_RANGE=worst) with each data width and both boundaries, and the lanes at the grids of
    LANE_GRIDS. The widest grids come first, so that all cores finish at about the same time.
    """
    stored, coefficients = (range(low, high + 1) for low, high in (WIDTHS[n].accepted for n in (STORED, COEFFICIENT)))
    points: list[Point] = []
    for solver in COLUMNS:
        points += [square(columns, solver=solver) for columns in GRIDS if columns != DEFAULT.columns]
        points.append(square(solver=solver, boundary="neumann"))
        for data in stored:
            points += [square(solver=solver, **{STORED: data, COEFFICIENT: c}) for c in coefficients]
            points.append(square(solver=solver, **{STORED: data}, **SAFE))
        points.append(square(solver=solver, boundary="neumann", **SAFE))
    for columns in LANE_GRIDS:
        points += [square(columns, solver="tridiagonal", lanes=lanes) for lanes in lane_counts(columns)[1:]]
    return sorted(points, key=lambda point: point.pixels, reverse=True)


def lane_counts(columns: int) -> list[int]:
    """Return every number of lanes that a tridiagonal solver of so many columns can have: 1, 2, 4, .."""
    return [1 << log2 for log2 in range(most_lanes(columns).bit_length())]


@lru_cache(maxsize=2)
def _bench(size: int, neumann: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return frames, true height in pixels, and depth in double precision."""
    scene = render(SCENE, size, seed=SEED)
    height = scene.height - scene.height.mean(axis=(1, 2), keepdims=True) if neumann else scene.height
    return scene.frames, height, reference.depth(scene.frames, synthetic(), neumann)


def measure(point: Point) -> dict[str, Any]:
    """Return the measurements of a configuration. Raises InputError: it cannot be built."""
    neumann = point.boundary == "neumann"
    deep = (
        deepest(point.rows, point.columns, neumann) * synthetic().gradient_limit if point.depth_range == WORST else None
    )
    same = {name: getattr(point, name) for name in ("solver", "rows", "columns", "lanes", *SOLVER_NUMBERS)}
    config = Configuration(neumann=neumann, depth_range_px=deep, **same)
    (frames, height, exact), pitch = _bench(config.columns, neumann), scene_pixel_pitch_mm(config.columns)
    monitor = Monitor()
    depth = Twin(synthetic(), config).depth_px(frames, monitor)
    rms, largest = (np.array(percent, float) for percent in errors(depth, exact).values())
    true = np.abs(depth - height) * pitch
    true_rms = np.sqrt((true**2).mean(axis=(1, 2)))
    counted = cost(config)
    return {
        "depth_range_mm": config.deepest_px * pitch,
        "frames": len(frames),
        "rms_percent_mean": rms.mean(),
        "rms_percent_worst": rms.max(),
        "max_percent_mean": largest.mean(),
        "max_percent_worst": largest.max(),
        "true_rms_mm_mean": true_rms.mean(),
        "true_rms_mm_worst": true_rms.max(),
        "true_max_mm_worst": true.max(),
        "saturations": monitor.saturations.total(),
        "first_depth_cycles": counted.first_depth_cycles,
        "last_pixel_to_first_depth_cycles": counted.last_pixel_cycles,
        "last_pixel_to_last_depth_cycles": counted.map_cycles,
        "multipliers": counted.tiles,
        "multipliers_18": counted.multipliers_of(ECP5),
        "memory_bits": counted.memory_bits,
        **{
            f"{kind.replace(' ', '_')}_bits": counted.bits_of(f"{kind}s")
            for kind in ("frame store", "delay line", "table", "row buffer")
        },
    }


SWEEP = Study("sweep", Point, Row, measure, SECONDS, lambda point: {"scene": SCENE, "seed": SEED})


def like(rows: Sequence[Row], wanted: Point, *varied: str) -> list[Row]:
    """Return the rows that can be built and differ from a configuration in the columns `varied` alone."""
    same = {name: value for name, value in vars(wanted).items() if name not in varied}
    return [row for row in built(rows) if same.items() <= vars(row).items()]


def with_lanes(rows: Sequence[Row], columns: int) -> list[Row]:
    """Return the rows that differ in their lanes alone, by rising number of lanes."""
    return sorted(like(rows, square(columns, solver="tridiagonal"), "lanes"), key=lambda row: row.lanes)


def cost_of_worst(rows: Sequence[Row], solver: str) -> list[str]:
    """Return the loss of accuracy with a depth range that no slopes exceed, and the word length that compensates it."""
    default, worst = (
        {getattr(row, STORED): row.rms_percent_mean for row in like(rows, square(solver=solver, **chosen), STORED)}
        for chosen in ({}, SAFE)
    )
    width = DEFAULTS[STORED]
    if width not in default or width not in worst:
        return []
    line = f"{solver}: {SAFE_WORD}, {worst[width]:.4f} % in place of {default[width]:.4f} %"
    enough = [wide for wide, error in worst.items() if error <= default[width]]
    return [f"{line}; as good again with {WORD}={min(enough)}" if enough else f"{line}; no words are as good"]


def area(row: Row) -> tuple[str, str]:
    return str(row.multipliers), f"{row.memory_bits / 1e6:.2f}"


def summary(rows: Sequence[Row]) -> str:
    """Return a line for each solver, boundary and number of lanes, and the narrowest sufficient words."""
    by_solver, by_lanes = [], []
    for row in like(rows, DEFAULT, "solver", "boundary"):
        rms = f"{row.rms_percent_mean:.4f}", f"{row.rms_percent_worst:.4f}"
        by_solver.append((f"{row.solver}, {row.boundary}", *rms, f"{row.first_depth_cycles:,}", *area(row)))
    for columns in LANE_GRIDS:
        for row in with_lanes(rows, columns):
            cycles = f"{row.last_pixel_to_first_depth_cycles:,}", f"{row.last_pixel_to_last_depth_cycles:,}"
            by_lanes.append((f"{columns} x {columns}, {row.lanes}", *cycles, *area(row)))
    costs = ("multipliers", "Mbit")
    lines = [str(Table(("solver, boundary", "mean RMS, % of peak", "worst", "cycles", *costs), by_solver))]
    for solver in COLUMNS:
        same = like(rows, square(solver=solver), STORED)
        narrow = [getattr(row, STORED) for row in same if row.rms_percent_mean <= published.RMS_PERCENT]
        if narrow:
            lines.append(f"{solver}: mean RMS at most {published.RMS_PERCENT} % from {WORD}={min(narrow)}")
        lines += cost_of_worst(rows, solver)
    if by_lanes:
        lines.append(str(Table(("lanes", "last pixel to first depth, cycles", "to last depth", *costs), by_lanes)))
    refused = len(rows) - len(built(rows))
    lines.append(f"{len(rows)} rows, {refused} of them of configurations that cannot be built")
    return "\n".join(lines)


def main(out: Place = DEFAULT_OUT, dask_scheduler: Name | None = None) -> None:
    print(summary(SWEEP.complete(plan(), out, dask_scheduler)))
    print(f"results: {os.path.relpath(out / 'sweep.csv')}")
