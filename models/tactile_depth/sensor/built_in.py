# SPDX-License-Identifier: Apache-2.0
"""The built-in calibrations, by name, and calibrations from files."""

from __future__ import annotations

from pathlib import Path

from tactile_depth.base.errors import Argument, InputError, InputWarning, warn
from tactile_depth.sensor.calibration_file import BUILT_IN, FOLDER, read_calibration
from tactile_depth.sensor.sensor import Sensor
from tactile_depth.sensor.view import CONVENTIONS, Crop, completed

_warned: set[Path] = set()  # files whose view is unknown


def calibrations() -> tuple[str, ...]:
    """Return the names of the built-in calibrations that `load` takes."""
    return BUILT_IN


def load(name_or_path: str | Path, camera_size: tuple[int, int] | None = None, *, crop: Crop | None = None) -> Sensor:
    """Return a built-in calibration by its name, one of `calibrations()`, or one from an `.npz` file.

    docs/calibration-file.md describes the format of the file. Files of version 0.1 hold only a pitch, `gradient` or
    `coefficients`, and `largest_slope`; they are read with a warning.

    Parameters
    ----------
    camera_size : (rows, columns), optional
        Size of the pictures that a file of version 0.1 was made from, which the file does not hold.
    crop : str, float or (width, height), optional
        What the calibration's pictures show of the sensor's full picture, for a file that does not hold it: as for
        `fit`.

    Raises
    ------
    InputError
        The file cannot be read, or `crop` contradicts it.

    Warns
    -----
    InputWarning
        Once for each file: it does not hold what its pictures show.
    """
    sensor = read(name_or_path, camera_size)
    if crop is not None:
        return completed(sensor, crop)
    if sensor.view is None and sensor.camera is not None and (path := Path(name_or_path).resolve()) not in _warned:
        _warned.add(path)
        problem = f"{name_or_path}: view unknown: it does not say what part of the sensor's full picture it is for"
        remedy = ("say with ", Argument("crop"), f" what the pictures show: {', '.join(CONVENTIONS)}, or a share")
        warn(InputWarning(problem, remedy=remedy))
    return sensor


def read(name_or_path: str | Path, camera_size: tuple[int, int] | None = None) -> Sensor:
    """Return a calibration as `load` does, without a word on its view."""
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
