# SPDX-License-Identifier: Apache-2.0
"""Ball presses drawn with known slopes and colours, for the tests of calibrations.

    python -m tests.ball_presses FOLDER [COUNT]

writes background.png, COUNT pictures of presses (12 by default) and presses.csv: `tactile-depth calibrate FOLDER`.
"""

import csv
import sys
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from tactile_depth.calibrate.press_pictures import camera_pitch_mm, gather
from tactile_depth.calibrate.presses import GridPresses, to_grid
from tactile_depth.sensor.scenes import LIGHTS
from tests import real_data

CAMERA, PITCH = (112, 160), 0.1  # rows and columns, mm per pixel
SENSITIVITY = 0.7  # deviation of a colour per unit of slope towards its light
BALLS = {6.0: 17.0, 8.0: 20.0}  # contact radius in pixels by diameter in mm
COLUMNS = ["frame", "diameter_mm", "centre_x_px", "centre_y_px", "contact_radius_px", "ball_radius_px"]


def weakness(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return 1 / strength of the lights by position in mm: quadratic, so that the fit can be exact."""
    return 1 + 0.03 * x - 0.02 * y + 0.004 * x * x + 0.002 * x * y + 0.006 * y * y


def drawn(presses: list[tuple[float, float, float, float]], seed: int) -> np.ndarray:
    """Return a picture of balls in the light of the synthetic sensor, uint8 (rows, columns, 3).

    Each press is x, y, contact radius, ball radius in pixels. Around the contact the gel levels out gradually.
    """
    rows, columns = np.indices(CAMERA, dtype=np.float64)
    slopes = np.zeros((*CAMERA, 2))
    for x, y, contact, ball in presses:
        offset = np.stack((columns - x, rows - y), axis=-1)
        distance = np.sqrt((offset**2).sum(axis=-1))
        nearest = np.minimum(distance, contact)
        steepness = nearest / np.sqrt(ball**2 - nearest**2) * np.exp(-(distance - nearest) / (0.3 * contact))
        slopes -= (steepness / np.maximum(distance, 1e-9))[..., None] * offset
    x_mm, y_mm = (columns - (CAMERA[1] - 1) / 2) * PITCH, (rows - (CAMERA[0] - 1) / 2) * PITCH
    deviation = SENSITIVITY * slopes @ LIGHTS.T / weakness(x_mm, y_mm)[..., None]
    light = 105 + np.stack((3 * x_mm, 20 * np.cos(y_mm / 4), -2 * y_mm), axis=-1)
    grain = np.random.default_rng(seed).normal(scale=0.7, size=light.shape)
    return np.clip(np.rint(light * (1 + deviation) + grain), 0, 255).astype(np.uint8)


def places() -> list[tuple[str, float, float, float, float, float]]:
    """Return frame, diameter, x, y, contact radius and ball radius of presses, some cut by the middle square."""
    chance, rows = np.random.default_rng(5), []
    for index in range(24):
        diameter = list(BALLS)[index % 2]
        x, y = chance.uniform(30, 130), chance.uniform(12, 100)
        rows.append((f"{index:02}.png", diameter, x, y, BALLS[diameter], diameter / 2 / PITCH))
    return rows


@cache
def pictures() -> dict[str, np.ndarray]:
    """Return the pictures of `places` by name, and the background."""
    drawings = {name: drawn([tuple(press)], 2 + index) for index, (name, _, *press) in enumerate(places())}  # type: ignore[list-item]
    return {"background.png": drawn([], 1), **drawings}


def table_rows() -> list[dict]:
    return [dict(zip(COLUMNS, row, strict=True)) for row in places()]


def write_table(folder: Path, rows: list[dict], columns: list[str] = COLUMNS) -> None:
    with (folder / "presses.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, columns, extrasaction="ignore")
        table.writeheader()
        table.writerows(rows)


def write_folder(folder: Path, count: int | None = None) -> Path:
    """Write the pictures and the table of so many presses, by default of all."""
    folder.mkdir()
    rows = table_rows()[:count]
    for name in ("background.png", *(row["frame"] for row in rows)):
        Image.fromarray(pictures()[name]).save(folder / name)
    write_table(folder, rows)
    return folder


def read(folder: Path, pitch_mm: float | None = None, **choices: Any) -> GridPresses:
    """Return the presses of a folder on the grid."""
    gathered = gather(folder)
    return to_grid(gathered, camera_pitch_mm(gathered, pitch_mm), **choices)


def real_folder() -> Path:
    """Return the folder of the real presses; skip the test if it is absent."""
    if not real_data.PRESENT:
        pytest.skip("TACTILE_DATA names no folder with gelslam/")
    return real_data.FOLDER / "gelslam"


if __name__ == "__main__":
    write_folder(Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 12)
