# SPDX-License-Identifier: Apache-2.0
"""Between ROS messages and arrays, without ROS: fields in, fields out, lengths in metres (REP 103, REP 118)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from tactile_depth import InputError, Result

M_PER_MM = 1e-3
ENCODINGS = ("rgb8", "bgr8")
DEPTH_ENCODING = "32FC1"
POINT_FIELDS = ("x", "y", "z")
FLOAT32 = 7  # sensor_msgs/PointField.FLOAT32
CONTACT_FIELDS = ("touching", "peak_m", "peak_x_m", "peak_y_m", "area_m2", "volume_m3", "centroid_x_m", "centroid_y_m")


def picture(height: int, width: int, step: int, encoding: str, data: Any) -> np.ndarray:
    """Return the picture of a sensor_msgs/Image.

    Parameters
    ----------
    height, width : int
        Pixels.
    step : int
        Bytes from row to row; more than `3 * width` where rows are padded.
    encoding : str
        One of `ENCODINGS`.
    data : bytes or a buffer of uint8

    Returns
    -------
    uint8 array (height, width, 3), RGB, contiguous

    Raises
    ------
    tactile_depth.InputError
        Another encoding, or the sizes do not agree.
    """
    if encoding not in ENCODINGS:
        raise InputError(f"encoding {encoding!r}: accepted are {', '.join(ENCODINGS)}: convert it with image_proc")
    values = np.frombuffer(data, np.uint8)
    if height < 1 or step < 3 * width or len(values) != height * step:
        raise InputError(f"{len(values)} bytes, step {step} for {width} x {height} pixels of 3 bytes: a broken message")
    pixels = values.reshape(height, step)[:, : 3 * width].reshape(height, width, 3)
    return np.ascontiguousarray(pixels if encoding == "rgb8" else pixels[..., ::-1])


def depth_image(result: Result) -> dict[str, Any]:
    """Return the fields of a sensor_msgs/Image of heights in metres: 32FC1, as REP 118 has depth images."""
    height = (result.height_mm * M_PER_MM).astype("<f4")
    rows, columns = height.shape
    return {
        "height": rows,
        "width": columns,
        "encoding": DEPTH_ENCODING,
        "is_bigendian": 0,
        "step": 4 * columns,
        "data": height.tobytes(),
    }


def points(result: Result) -> dict[str, Any]:
    """Return the fields of an organised sensor_msgs/PointCloud2 in metres, but for `fields`: see `POINT_FIELDS`.

    x to the right and y down the picture from the middle of its first pixel, z the height above the untouched surface.
    """
    rows, columns = result.height_mm.shape
    y, x = np.mgrid[:rows, :columns] * (result.pixel_pitch_mm * M_PER_MM)
    cloud = np.stack([x * result.pixel_aspect, y, result.height_mm * M_PER_MM], axis=-1).astype("<f4")
    size = 4 * len(POINT_FIELDS)
    return {
        "height": rows,
        "width": columns,
        "is_bigendian": False,
        "point_step": size,
        "row_step": size * columns,
        "is_dense": bool(np.isfinite(cloud).all()),
        "data": cloud.tobytes(),
    }


def contact(result: Result) -> list[float]:
    """Return the contact record as numbers in the order of `CONTACT_FIELDS`.

    Positions count from the upper left corner of the picture; they are NaN without contact.
    """
    record, nowhere = result.contact, (math.nan, math.nan)
    peak_row, peak_column = record.peak_position_mm or nowhere
    row, column = record.centroid_mm or nowhere
    return [
        float(record.touching),
        record.peak_mm * M_PER_MM,
        peak_column * M_PER_MM,
        peak_row * M_PER_MM,
        record.area_mm2 * M_PER_MM**2,
        record.volume_mm3 * M_PER_MM**3,
        column * M_PER_MM,
        row * M_PER_MM,
    ]
