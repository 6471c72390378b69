# SPDX-License-Identifier: Apache-2.0
"""Real ball presses, which commands take without PRESSES."""

import os
from pathlib import Path

import numpy as np

from commands.common import repository
from tactile_depth.base.errors import InputError
from tactile_depth.calibrate.ball_press import BallPress
from tactile_depth.pictures.frames import read_picture

PUBLIC_PRESSES = (
    "give PRESSES=<folder with background.png, pictures of ball presses and presses.csv>; real ones are in the public "
    "repository rpl-cmu/gelslam, src/gelslam/resources/example_calibration: put frame and diameter_mm of its "
    "catalog.csv into presses.csv, and set PITCH=0.0634"
)


def data_folder() -> Path:
    """Return the folder of real presses: `gelslam/` in `TACTILE_DATA`, or in ../shared/data beside the repository.

    Raises InputError: it holds no presses.csv.
    """
    beside = repository.ROOT.parent / "shared" / "data"
    folder = Path(os.environ.get("TACTILE_DATA") or beside) / "gelslam"
    if not (folder / "presses.csv").is_file():
        raise InputError(f"no presses: {folder} holds no presses.csv: {PUBLIC_PRESSES}")
    return folder


def pixels(press: BallPress) -> np.ndarray:
    """Return the picture of a press, uint8 (rows, columns, 3). Raises InputError: it cannot be read."""
    return press.image if isinstance(press.image, np.ndarray) else read_picture(Path(press.image))
