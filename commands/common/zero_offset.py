# SPDX-License-Identifier: Apache-2.0
"""Zero offset of a request: the frames that ZERO names, and what a capture of them measures."""

from dataclasses import replace

import numpy as np

from commands.common.run_request import Request
from tactile_depth.base.errors import InputError
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.depth.zero_capture import LARGEST_LOG2, captured_zero
from tactile_depth.chip.tactile_depth import light_of, slope_tables, tactile_depth
from tactile_depth.pictures.frames import REST_SCENE, Frames, load_frames
from tactile_depth.sensor.scenes import SCENES
from tactile_depth.sensor.sensor import Sensor


def untouched(request: Request, frames: Frames) -> np.ndarray | None:
    """Return the frames of `ZERO`, uint8 (a power of two, rows, columns, 3); None without it. Raises InputError."""
    if request.zero is None:
        return None
    if not request.frames and request.zero == REST_SCENE and frames.picture_size is not None:
        return frames.pixels  # a flat picture of a real sensor, `flat_frames`
    reference = request.reference if request.zero in SCENES else None
    no_contact = load_frames(request.zero, frames.pixels.shape[1:3], reference, request.seed, camera=request.camera)
    if no_contact.pixel_scale != frames.pixel_scale:
        raise InputError(f"ZERO={request.zero}: not of the size of {frames.name}: give frames of the same camera")
    return no_contact.pixels[: 1 << min(LARGEST_LOG2, len(no_contact.pixels).bit_length() - 1)]


def zero_of(no_contact: np.ndarray | None, calibration: Sensor, config: Configuration) -> np.ndarray | None:
    """Return the zero offset that a capture of these frames measures, codes (node rows, node columns)."""
    if no_contact is None:
        return None
    tables = slope_tables(calibration, config)
    light = light_of(no_contact, tables, config)
    as_read = replace(config, zero_offset=False)
    return captured_zero(tactile_depth(no_contact, calibration, as_read, tables=tables, light=light), config)
