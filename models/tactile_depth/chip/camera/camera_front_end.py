# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/camera/camera_front_end.sv, picture by picture."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.camera.area_average import LATENCY as AREA_AVERAGE
from tactile_depth.chip.camera.area_average import area_average
from tactile_depth.chip.camera.black_level import LATENCY as BLACK_LEVEL
from tactile_depth.chip.camera.black_level import black_level
from tactile_depth.chip.camera.camera_window import LATENCY as CAMERA_WINDOW
from tactile_depth.chip.camera.pixel_format import latency as pixel_format_latency
from tactile_depth.chip.camera.pixel_format import pixel_format, pixel_format_parameters
from tactile_depth.chip.camera_configuration import GAIN, CameraConfiguration
from tactile_depth.chip.common.td_axis_skid import LATENCY as AXIS_SKID

SETTINGS = {"columns": 13, "rows": 13, "window_x": 13, "window_y": 13, "black_level": 12}
SETTINGS |= dict.fromkeys(("red_gain", "green_gain", "blue_gain"), GAIN.width)
"""Members of `camera_settings_t` (hdl/td_types_pkg.sv) and their bits, the first on top."""
RESETS = ("PictureColumns", "PictureRows", "WindowX", "WindowY", "BlackLevel", "RedGain", "GreenGain", "BlueGain")
OF_RESET = dict(zip(SETTINGS, RESETS, strict=True))
"""Parameters of hdl/camera/camera_registers.sv that give the settings after a reset."""


def camera_front_end_parameters(camera: CameraConfiguration) -> dict[str, int]:
    """Parameters of hdl/camera/camera_front_end.sv."""
    return {
        "Rows": camera.grid[0],
        "Columns": camera.grid[1],
        "Numerator": camera.ratio.numerator,
        "Denominator": camera.ratio.denominator,
        **pixel_format_parameters(camera),
    }


def camera_settings(camera: CameraConfiguration) -> dict[str, int]:
    """Return the settings of the core, by the members of `camera_settings_t`."""
    rows, columns = camera.picture
    numbers = (columns, rows, *camera.crop[:2], camera.black_level, *camera.gain_codes)
    return dict(zip(SETTINGS, numbers, strict=True))


def reset_parameters(camera: CameraConfiguration) -> dict[str, int]:
    """Return the parameters that give the settings after a reset."""
    return {OF_RESET[name]: number for name, number in camera_settings(camera).items()}


def camera_front_end(words: np.ndarray, camera: CameraConfiguration) -> np.ndarray:
    """Return the frame of the grid for a picture in the camera's format.

    Parameters
    ----------
    words : int array (rows, columns)
        One word for each pixel (`pixel_format`).

    Returns
    -------
    uint8 array (grid rows, grid columns, 3), RGB
    """
    x, y, width, height = camera.crop
    colour = None
    if camera.format.bayer:
        colour = (y + (camera.phase_code >> 1)) % 2, (x + camera.phase_code) % 2
    samples = black_level(pixel_format(words, camera)[y : y + height, x : x + width], camera.black_level)
    rows, columns = camera.grid
    ratio = camera.ratio
    means = area_average(samples, camera.bits, ratio.numerator, ratio.denominator, colour, camera.gain_codes)
    return means[:rows, :columns]


def latency(camera: CameraConfiguration) -> int:
    """Return the cycles from the camera's `last_word` to the last pixel of the grid, for any gaps."""
    x, _, width, _ = camera.crop
    first_of_pair = camera.format.is_yuyv and (x + width) % 2 == 1
    cores = CAMERA_WINDOW + pixel_format_latency(camera) - first_of_pair + BLACK_LEVEL + AREA_AVERAGE
    return AXIS_SKID + cores + AXIS_SKID
