# SPDX-License-Identifier: Apache-2.0
"""Measures the errors of the bit-accurate models for one configuration of a sweep.

Errors are taken against double precision and against the height map that was drawn. No scale or offset is fitted.
"""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from typing import Any

import numpy as np

from commands.cost.cost import ECP5, cost
from commands.study.certificate import deepest
from tactile_depth.base.errors import InputError
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import SOLVER_WIDTHS, Configuration
from tactile_depth.chip.limits import BOUNDARIES
from tactile_depth.depth import reference
from tactile_depth.depth.twin import Twin
from tactile_depth.sensor.scenes import render, scene_pixel_pitch_mm
from tactile_depth.sensor.synthetic import synthetic

SMALLEST_PEAK_PX = 0.1  # the error in % of the peak is not defined below this peak
SCENE, SEED = "bench", 1  # the scene that a sweep measures, and the seed of its noise


def _version() -> str:
    """Return a digest of the sources of all models; rows with different digests are not comparable."""
    digest = hashlib.sha256()

    def add(folder: Any) -> None:
        for entry in sorted(folder.iterdir(), key=lambda entry: entry.name):
            if entry.is_dir():
                add(entry)
            elif entry.name.endswith(".py"):
                digest.update(entry.name.encode() + b"\0" + entry.read_bytes() + b"\0")

    add(files("tactile_depth"))
    return digest.hexdigest()[:12]


VERSION = _version()  # computed at import, so that it belongs to the code that runs


def errors(depth_px: np.ndarray, reference_px: np.ndarray) -> dict[str, list[float | None]]:
    """Return the RMS and the largest error of each frame (frames, rows, columns), in % of the reference's peak.

    The error of a frame whose peak is below SMALLEST_PEAK_PX is None.
    """
    error = depth_px - reference_px
    peak = np.abs(reference_px).max(axis=(1, 2))
    rms = np.sqrt((error**2).mean(axis=(1, 2)))
    largest = np.abs(error).max(axis=(1, 2))
    percent = [
        [float(100 * v / p) if p >= SMALLEST_PEAK_PX else None for v, p in zip(values, peak, strict=True)]
        for values in (rms, largest)
    ]
    return {"rms_percent_of_peak": percent[0], "max_percent_of_peak": percent[1]}


@dataclass(frozen=True)
class _Bench:
    frames: np.ndarray
    height: np.ndarray
    reference: np.ndarray


@lru_cache(maxsize=2)
def _bench(size: int, neumann: bool) -> _Bench:
    scene = render(SCENE, size, seed=SEED)
    height = scene.height - scene.height.mean(axis=(1, 2), keepdims=True) if neumann else scene.height
    return _Bench(scene.frames, height, reference.depth(scene.frames, synthetic(), neumann))


WORST = math.inf  # as a depth range: the largest depth that any slopes can reach
CONFIGURATION = ("solver", "boundary", "rows", "columns", "lanes", *SOLVER_WIDTHS, "depth_range")
MEASURED = (
    "problem",
    "depth_range_mm",
    "scene",
    "seed",
    "frames",
    "rms_percent_mean",
    "rms_percent_worst",
    "max_percent_mean",
    "max_percent_worst",
    "true_rms_mm_mean",
    "true_rms_mm_worst",
    "true_max_mm_worst",
    "saturations",
    "first_depth_cycles",
    "last_pixel_to_first_depth_cycles",
    "last_pixel_to_last_depth_cycles",
    "multipliers",
    "multipliers_18",
    "memory_bits",
    "frame_store_bits",
    "delay_line_bits",
    "table_bits",
    "row_buffer_bits",
    "models",
)


def configuration_cells(choices: dict[str, Any]) -> dict[str, str]:
    """Return the cells of a row that describe its configuration, from the arguments of a `Configuration`."""
    columns, depth_range = choices.get("columns", Configuration.columns), choices.get("depth_range_px")
    described = {
        "boundary": BOUNDARIES[not choices.get("neumann")],
        "rows": columns,
        "depth_range": {None: "default", WORST: "worst"}.get(depth_range, depth_range),
    } | choices
    return {name: str(described.get(name, getattr(Configuration, name, ""))) for name in CONFIGURATION}


def measure(choices: dict[str, Any]) -> dict[str, str]:
    """Measure a configuration over the contacts of the bench.

    For a configuration that cannot be built, the cell `problem` says why and the measurements are empty.

    Parameters
    ----------
    choices : dict
        Arguments of a `Configuration`, of a square grid; `depth_range_px` may be WORST.

    Returns
    -------
    dict of str
        The columns CONFIGURATION and MEASURED. `*_percent_*` is the error against double precision in % of its peak,
        mean and worst over the contacts. `true_*_mm` is the error against the height map that was drawn; it includes
        the error of the sensor.
    """
    row = dict.fromkeys((*CONFIGURATION, *MEASURED), "")
    row |= configuration_cells(choices) | {"scene": SCENE, "seed": str(SEED), "models": VERSION}
    if choices.get("depth_range_px") == WORST:
        grid = Configuration(**{name: value for name, value in choices.items() if name in ("solver", "columns")})
        range_px = deepest(grid.rows, grid.columns, choices.get("neumann", False)) * synthetic().gradient_limit
        choices = choices | {"depth_range_px": range_px}
    try:
        config = Configuration(**choices)
    except InputError as error:
        return row | {"problem": str(error)}
    bench, pitch = _bench(config.columns, config.neumann), scene_pixel_pitch_mm(config.columns)
    monitor = Monitor()
    depth = Twin(synthetic(), config).depth_px(bench.frames, monitor)
    percent = errors(depth, bench.reference)
    rms = np.array(percent["rms_percent_of_peak"], float)
    largest = np.array(percent["max_percent_of_peak"], float)
    true = np.abs(depth - bench.height) * pitch
    true_rms = np.sqrt((true**2).mean(axis=(1, 2)))
    counted = cost(config)
    numbers = {
        "depth_range_mm": config.deepest_px * pitch,
        "frames": len(bench.frames),
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
        "frame_store_bits": counted.bits_of("frame stores"),
        "delay_line_bits": counted.bits_of("delay lines"),
        "table_bits": counted.bits_of("tables"),
        "row_buffer_bits": counted.bits_of("row buffers"),
    }
    return row | {name: str(v) if isinstance(v, int) else f"{float(v):.6g}" for name, v in numbers.items()}
