# SPDX-License-Identifier: Apache-2.0
"""The sensor that took a picture, found by its lighting."""

from __future__ import annotations

import numpy as np

from tactile_depth.base.errors import Argument, InputError, Part
from tactile_depth.pictures.exchanges import CORRECT_IT, exchange_of
from tactile_depth.pictures.grid_sampler import middle
from tactile_depth.pictures.pictures import HasArray, HasInterface, array_of, is_array
from tactile_depth.pictures.view_check import shares_shown
from tactile_depth.sensor.built_in import load
from tactile_depth.sensor.calibration_file import BUILT_IN
from tactile_depth.sensor.sensor import LIGHTING_AGREES, Sensor
from tactile_depth.sensor.view import Crop, shown

PICTURE = "uint8 (rows, columns, 3), RGB"


def identify(reference: np.ndarray | HasArray | HasInterface, *, crop: Crop | None = None) -> Sensor:
    """Return the built-in calibration of the sensor that took a picture without contact, found by its lighting.

    Parameters
    ----------
    reference : uint8 array (rows, columns, 3), RGB, or a PIL image
        Picture of the sensor's camera.
    crop : str, float or (width, height), optional
        What it shows of the sensor's full picture, as for a Pipeline.

    Raises
    ------
    InputError
        No built-in calibration has the aspect ratio and the lighting of the picture.
    """
    if not is_array(reference):
        raise InputError("the ", Argument("reference"), f" is a {type(reference).__name__}", accepted=PICTURE)
    reference = array_of(reference, Argument("reference"))
    if reference.dtype != np.uint8 or reference.ndim != 3 or reference.shape[-1] != 3 or min(reference.shape) < 3:
        raise InputError("the ", Argument("reference"), f" is {reference.dtype} {reference.shape}", accepted=PICTURE)
    rows, columns = reference.shape[:2]
    nearest, reasons = None, []
    mend: tuple[Part, ...] = (
        () if crop is None else (", or correct ", Argument("crop", crop), ", what the pictures show")
    )
    for sensor in map(load, BUILT_IN):
        if sensor.camera is None or sensor.lighting is None:
            continue
        seen, share = shown(sensor, crop)
        cut = middle(reference, share)
        difference = seen.lighting_difference(cut)
        try:
            seen.zoom((rows, columns), share=share)
        except InputError:
            takes = f"{sensor.name} takes {sensor.camera.columns} x {sensor.camera.rows}"
            used = "" if crop is None else f", of which {cut.shape[1]} x {cut.shape[0]} are used"
            reasons.append(f"{takes}, this has {columns} x {rows} pixels{used}")
            if (columns < rows) != (sensor.camera.columns < sensor.camera.rows):
                mend = (", or rotate all pictures by 90 or 270 degrees: --rotate, or numpy.rot90",)
            continue
        if seen.untouched is not None and shares_shown(cut, seen.untouched) != (1, 1):
            return sensor  # in another view, which a pipeline names
        exchange = exchange_of(seen, cut)
        if difference > LIGHTING_AGREES or exchange:
            mend = (f", or {CORRECT_IT}",) if exchange else mend
            reasons.append(
                f"its lighting differs from {sensor.name} by {100 * difference:.0f} %, accepted are "
                f"{100 * LIGHTING_AGREES:.0f} %{exchange and f', but {exchange}'}"
            )
        elif nearest is None or difference < nearest[0]:
            nearest = difference, sensor
    if nearest is None:
        raise InputError(
            f"the reference looks like no sensor with a built-in calibration ({'; '.join(reasons)})",
            remedy=("give the ", Argument("calibration"), " of the sensor that took it", *mend),
        )
    return nearest[1]
