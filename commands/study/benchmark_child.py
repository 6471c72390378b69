# SPDX-License-Identifier: Apache-2.0
"""Child process of `make benchmark`: runs one version of the models, one case at a time, as the parent asks.

Arguments are the folders of the version, of the pictures and of the results. Every line on the standard input is the
name of a case; the answer is one line, the time of the case in ms per frame. The first run of a case writes its depth
maps to `<case>.npy` in the folder of the results. The parent is commands/study/benchmark.py.
"""

import gc
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

GRID = (128, 128)
CHOICES: dict[str, Any] = {"rows": GRID[0], "columns": GRID[1], "solver": "tridiagonal", "neumann": True}
CHOICES |= {"flat_field": True, "gradient_model": "quadratic"}
CASES = {"chip": 1, "float": 1, "chip, batch of 16": 16}
"""Pictures of each case by its name."""

Solve = Callable[[np.ndarray], np.ndarray]


def import_path(folder: Path) -> Path:
    """Return the folder to import the version from: that of `tactile_depth`, or that of `models`."""
    return folder / "models" if (folder / "models" / "tactile_depth").is_dir() else folder


# Each version as a user calls it: uint8 (pictures, rows, columns, 3) of the camera to depth in mm, float64. Objects
# that pictures share are prepared first.


def package_tactile_depth(no_contact: np.ndarray) -> tuple[Solve, Solve]:
    """Return `chip` and `float` of the package."""
    from tactile_depth.pipeline import Pipeline
    from tactile_depth.sensor import Camera, synthetic

    sensor = replace(synthetic(), camera=Camera(*no_contact.shape[:2]), model="quadratic")

    def pipeline(arithmetic: str) -> Solve:
        made = Pipeline(sensor, no_contact, grid=GRID, zero_offset=False, arithmetic=arithmetic)
        return lambda pictures: made(pictures).depth_mm

    return pipeline("chip"), pipeline("float")


def package_models(no_contact: np.ndarray) -> tuple[Solve, Solve]:
    """Return `chip` and `float` of the modules from before the package."""
    from models.calibration import synthetic
    from models.configuration import Configuration
    from models.frames import resampling

    from models import reference
    from models.tactile_depth import tactile_depth

    plan = resampling(no_contact.shape[:2], GRID)
    calibration = synthetic().on_grid(plan.scale, np.rint(plan.average(no_contact)).astype(np.uint8))
    config = Configuration(gradient_limit=calibration.gradient_limit, **CHOICES)

    def chip(pictures: np.ndarray) -> np.ndarray:
        frames = np.stack([np.rint(plan.average(picture)).astype(np.uint8) for picture in pictures])
        return tactile_depth(frames, calibration, config)[:, ::-1] * (config.depth_lsb_px * calibration.pixel_pitch_mm)

    def exact(pictures: np.ndarray) -> np.ndarray:
        frames = np.stack([np.rint(plan.average(picture)).astype(np.uint8) for picture in pictures])
        return reference.depth_of(frames, calibration, config) * calibration.pixel_pitch_mm

    return chip, exact


def main() -> None:
    """Answer every line of the standard input."""
    folder, pictures_folder, results = map(Path, sys.argv[1:])
    sys.path[0] = str(import_path(folder))  # before the installed package
    no_contact = np.load(pictures_folder / "no_contact.npy")
    pictures = np.load(pictures_folder / "pictures.npy")
    package = package_models if import_path(folder) == folder else package_tactile_depth
    chip, exact = package(no_contact)
    gc.disable()
    for line in sys.stdin:
        case = line.strip()
        solve, batch = exact if case == "float" else chip, pictures[: CASES[case]]
        begin = time.perf_counter_ns()
        depth = solve(batch)
        elapsed = time.perf_counter_ns() - begin
        if not (results / f"{case}.npy").exists():
            np.save(results / f"{case}.npy", depth)
        print(elapsed / 1e6 / len(batch), flush=True)


if __name__ == "__main__":
    main()
