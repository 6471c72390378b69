# SPDX-License-Identifier: Apache-2.0
"""The built-in calibrations, by name or by a picture, and calibrations from files."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tactile_depth.base.errors import Argument, InputError
from tactile_depth.base.npy import HasArray, HasInterface, is_array
from tactile_depth.pictures.exchanges import exchange_of
from tactile_depth.sensor.calibration_file import BUILT_IN, FOLDER, read_calibration
from tactile_depth.sensor.scenes import GAIN, LIGHTS, REST, SYNTHETIC_PIXEL_PITCH_MM
from tactile_depth.sensor.sensor import COEFFICIENTS, CORRECTIONS, CUBIC, LIGHTING_AGREES, Sensor

PICTURE = "uint8 (rows, columns, 3), RGB"
LARGEST_SLOPE = 0.99  # largest slope of the synthetic table, so that its gradient limit is 1


def load(name_or_path: str | Path, camera_size: tuple[int, int] | None = None) -> Sensor:
    """Return a built-in calibration by its name, or one from an `.npz` file.

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
        return synthetic()
    if name_or_path in BUILT_IN:
        return read_calibration(str(name_or_path), FOLDER / f"{name_or_path}.npz", camera_size)
    return read_calibration(str(name_or_path), Path(name_or_path), camera_size)


def identify(reference: np.ndarray | HasArray | HasInterface) -> Sensor:
    """Return the built-in calibration of the sensor that took a picture without contact, found by its lighting.

    Parameters
    ----------
    reference : uint8 array (rows, columns, 3), RGB, or a PIL image
        Full picture of the sensor's camera.

    Raises
    ------
    InputError
        No built-in calibration has the aspect ratio and the lighting of the picture.
    """
    if not is_array(reference):
        raise InputError("the ", Argument("reference"), f" is a {type(reference).__name__}", accepted=PICTURE)
    reference = np.asarray(reference)
    if reference.dtype != np.uint8 or reference.ndim != 3 or reference.shape[-1] != 3 or min(reference.shape) < 3:
        raise InputError("the ", Argument("reference"), f" is {reference.dtype} {reference.shape}", accepted=PICTURE)
    rows, columns = reference.shape[:2]
    nearest, reasons = None, []
    for sensor in map(load, BUILT_IN):
        if sensor.camera is None or sensor.lighting is None:
            continue
        difference = sensor.lighting_difference(reference)
        try:
            sensor.zoom((rows, columns))
        except InputError:
            camera = sensor.camera
            reasons.append(f"{sensor.name} takes {camera.columns} x {camera.rows}, this has {columns} x {rows} pixels")
            continue
        exchange = exchange_of(sensor, reference)
        if difference > LIGHTING_AGREES or exchange:
            reasons.append(
                f"its lighting differs from {sensor.name} by {100 * difference:.0f} %, accepted are "
                f"{100 * LIGHTING_AGREES:.0f} %{exchange and f', but {exchange}'}"
            )
        elif nearest is None or difference < nearest[0]:
            nearest = difference, sensor
    if nearest is None:
        raise InputError(
            f"the reference looks like no sensor with a built-in calibration ({'; '.join(reasons)})",
            remedy=("give the ", Argument("calibration"), " of the sensor that took it"),
        )
    return nearest[1]


def synthetic(bits_per_channel: int = 4) -> Sensor:
    """Return the synthetic sensor: the least-squares inverse of its colour model, as a table and as polynomials.

    The light is uniform and the colours are linear in the slopes, so only the first term of each polynomial is not 0.
    """
    step = 256 >> bits_per_channel
    centre = np.arange(0, 256, step) + (step - 1) / 2
    colour = np.stack(np.meshgrid(centre, centre, centre, indexing="ij"), axis=-1)
    gradient = (colour - REST) / GAIN @ np.linalg.pinv(LIGHTS).T
    within = np.clip(gradient, -LARGEST_SLOPE, LARGEST_SLOPE)
    coefficients = np.zeros(COEFFICIENTS)
    coefficients[..., 0] = REST / GAIN * np.linalg.pinv(LIGHTS)
    cubic, corrections = np.zeros(CUBIC), np.zeros(CORRECTIONS)
    cubic[..., 0] = coefficients[..., 0]
    pitch = SYNTHETIC_PIXEL_PITCH_MM
    return Sensor("synthetic", within, pitch, coefficients, LARGEST_SLOPE, cubic=cubic, corrections=corrections)
