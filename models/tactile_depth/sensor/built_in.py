# SPDX-License-Identifier: Apache-2.0
"""The built-in calibrations, by name, and calibrations from files."""

from __future__ import annotations

from pathlib import Path

from tactile_depth.base.errors import Argument, InputError
from tactile_depth.sensor.calibration_file import BUILT_IN, FOLDER, read_calibration
from tactile_depth.sensor.sensor import Sensor


def calibrations() -> tuple[str, ...]:
    """Return the names of the built-in calibrations that `load` takes."""
    return BUILT_IN


def load(name_or_path: str | Path, camera_size: tuple[int, int] | None = None) -> Sensor:
    """Return a built-in calibration by its name, one of `calibrations()`, or one from an `.npz` file.

    docs/calibration-file.md describes the format of the file. Files of version 0.1 hold only a pitch, `gradient` or
    `coefficients`, and `largest_slope`; they are read with a warning.

    Parameters
    ----------
    camera_size : (rows, columns), optional
        Size of the pictures that a file of version 0.1 was made from, which the file does not hold.

    Raises
    ------
    InputError
    """
    if not isinstance(name_or_path, str | Path):
        raise InputError(f"a calibration is named by a {type(name_or_path).__name__}: accepted is a name or a path")
    if name_or_path == "synthetic":
        if camera_size is not None:
            raise InputError(
                Argument("camera_size", camera_size),
                " with the synthetic sensor, which takes pictures of any size",
                remedy=("omit ", Argument("camera_size")),
            )
        from tactile_depth.sensor.synthetic import synthetic  # draws scenes, which no other calibration needs

        return synthetic()
    if name_or_path in BUILT_IN:
        return read_calibration(str(name_or_path), FOLDER / f"{name_or_path}.npz", camera_size)
    return read_calibration(str(name_or_path), Path(name_or_path), camera_size)
