# SPDX-License-Identifier: Apache-2.0
"""Views: the share of a sensor's full picture that pictures show."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np

from tactile_depth.base.errors import Argument, InputError, Part, is_number
from tactile_depth.chip.resampling import WHOLE, Share
from tactile_depth.sensor.sensor import Sensor, lighting

# What software for a GelSight Mini cuts off before anything else: gs_sdk's `resize_crop` 1/7 at each border, gsrobotics
# 0.15. A plain camera cuts nothing.
CONVENTIONS = {"none": 1.0, "gs_sdk": 5 / 7, "gsrobotics": 0.70}
SMALLEST_VIEW = 0.05
ACCEPTED = (
    *CONVENTIONS,
    f"or the share of the full picture's width and height that pictures show, {SMALLEST_VIEW:g} to 1, as 0.7",
)

VIEWS_AGREE = 0.01  # largest relative difference between two values of one view: 5/7 is also written 0.71
LARGEST_DENOMINATOR = 1000  # of a share: 5/7 and 0.971 are exact

# Longer side of what pictures show of a fingertip. A DIGIT shows 16 mm (320 pixels of 0.051 mm, docs/digit.md), a
# GelSight Mini 20 mm (its calibration), a GelSight R1.5 28 mm (320 pixels of 0.0877 mm, Isaac Lab); a factor of 4 and
# more of margin on both sides, for parts of a picture, finer lenses and longer gels.
FIELD_MM = (3, 120)

Crop = str | float | tuple[float, float]


def view_of(crop: Crop) -> tuple[float, float]:
    """Return the shares of width and height that `crop` names: a convention, a share, or a share of each.

    Raises
    ------
    InputError
    """
    shares: Any = CONVENTIONS.get(crop, crop) if isinstance(crop, str) else crop
    if isinstance(shares, str):
        shares = tuple(map(_number, shares.split(",")))
    pair = tuple(shares) if isinstance(shares, tuple | list) else (shares,)
    pair = pair * 2 if len(pair) == 1 else pair
    if len(pair) != 2 or not all(map(is_share, pair)):
        raise InputError(Argument("crop", crop), accepted=ACCEPTED)
    return float(pair[0]), float(pair[1])


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


def is_share(share: object) -> bool:
    """Return True for a share of a picture's width or height that a view can have."""
    return is_number(share) and SMALLEST_VIEW <= float(share) <= 1  # type: ignore[arg-type]


def require_field(size: tuple[int, int], pitch_mm: float, *pitch: Part, remedy: str | Iterable[Part]) -> None:
    """Raise InputError unless pictures (rows, columns) of pixels of `pitch_mm` show as much as a fingertip has.

    Parameters
    ----------
    pitch : parts of the message that name the pitch
    """
    (rows, columns), (low, high) = size, FIELD_MM
    if not low <= max(size) * pitch_mm <= high:
        problem = (
            f": pictures of {columns} x {rows} pixels show {columns * pitch_mm:.3g} x {rows * pitch_mm:.3g} mm of gel"
        )
        raise InputError(*pitch, problem, accepted=f"{low} to {high} mm along the longer side", remedy=remedy)


def completed(sensor: Sensor, crop: Crop) -> Sensor:
    """Return a sensor with a view; `crop` is what the calibration's pictures show.

    Raises
    ------
    InputError
        The sensor has another view, or takes pictures of any size.
    """
    view, named = view_of(crop), Argument("crop", crop)
    if sensor.camera is None:
        problem = f" with the {sensor.name} sensor, which takes pictures of any size"
        raise InputError(named, problem, remedy=("omit ", Argument("crop")))
    if sensor.view is None:
        return replace(sensor, view=view)
    if any(abs(given / held - 1) > VIEWS_AGREE for given, held in zip(view, sensor.view, strict=True)):
        width, height = sensor.view
        problem = f" contradicts {sensor.name}, whose pictures show {width:.3g} of the full width and {height:.3g} of"
        remedy = ("omit it; to a pipeline ", Argument("crop"), " says what its pictures show")
        raise InputError(named, f"{problem} the full height", remedy=remedy)
    return sensor


def shown(sensor: Sensor, crop: Crop | None) -> tuple[Sensor, Share]:
    """Return the sensor for what its pictures and those of a crop both show, and the share of the latter that is that.

    Parameters
    ----------
    crop : Crop or None
        What the pictures show; None: what those of the calibration show. It completes a sensor without a view.

    Raises
    ------
    InputError
        The crop is not accepted, or the sensor is that of a pipeline.
    """
    sensor.require_no_grid()
    if crop is None:
        return sensor, WHOLE
    if sensor.view is None or sensor.camera is None:
        sensor = completed(sensor, crop)
    assert sensor.view is not None
    (rows, columns), (own_rows, own_columns) = share_of(view_of(crop)), share_of(sensor.view)
    both = min(rows, own_rows), min(columns, own_columns)
    return _cut(sensor, (both[0] / own_rows, both[1] / own_columns)), (both[0] / rows, both[1] / columns)


def share_of(view: tuple[float, float]) -> Share:
    """Return shares of width and height as exact shares of rows and columns."""
    columns, rows = (Fraction(share).limit_denominator(LARGEST_DENOMINATOR) for share in view)
    return rows, columns


def _cut(sensor: Sensor, share: Share) -> Sensor:
    """Return the sensor for a share of its pictures, as if a camera of smaller pixels showed that share alone."""
    if share == WHOLE:
        return sensor
    assert sensor.camera is not None
    assert sensor.view is not None
    scale, camera = max(share), sensor.camera
    rows, columns = (round(n * part / scale) for n, part in zip((camera.rows, camera.columns), share, strict=True))
    untouched, light = (None if held is None else _middle(held, share) for held in (sensor.untouched, sensor.lighting))
    light = light if untouched is None else untouched
    return replace(
        sensor,
        pixel_pitch_mm=sensor.pixel_pitch_mm * float(scale),
        camera=replace(camera, rows=rows, columns=columns),
        lighting=None if light is None else lighting(light),
        untouched=untouched,
        view=(sensor.view[0] * float(share[1]), sensor.view[1] * float(share[0])),
    )


def _middle(areas: np.ndarray, share: Share) -> np.ndarray:
    """Return what areas of a picture (rows, columns, 3) hold in a share of it, in as many areas, interpolated."""
    for axis, part in enumerate(map(float, share)):
        count = areas.shape[axis]
        at = (np.arange(count) - (count - 1) / 2) * part + (count - 1) / 2
        weights = np.maximum(0, 1 - np.abs(at[:, None] - np.arange(count)))
        areas = np.moveaxis(np.tensordot(weights, areas, (1, axis)), 0, axis)
    return areas
