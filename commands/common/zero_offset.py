# SPDX-License-Identifier: Apache-2.0
"""Frames without contact, that ZERO names."""

import numpy as np

from commands.common.run_request import Request
from tactile_depth.base.errors import InputError
from tactile_depth.chip.depth.zero_capture import LARGEST_LOG2
from tactile_depth.pictures.blocks import Rest
from tactile_depth.pictures.frames import REST_SCENE, Frames, check_frames, load_frames
from tactile_depth.pictures.reference_check import check_zero
from tactile_depth.sensor.scenes import SCENES


def untouched(request: Request, frames: Frames) -> np.ndarray | None:
    """Return the frames of `ZERO`, uint8 (a power of two, rows, columns, 3); None without it.

    Warns if they show other light or contact than the reference of `frames`, pictures of a sensor. Raises InputError.
    """
    if request.zero is None:
        return None
    if not request.frames and request.zero == REST_SCENE and frames.picture_size is not None:
        return frames.pixels  # a flat picture of a real sensor, `flat_frames`
    reference = request.reference if request.zero in SCENES else None
    no_contact = load_frames(
        request.zero, frames.pixels.shape[1:3], reference, request.seed, camera=request.camera, share=frames.share
    )
    if no_contact.pixel_scale != frames.pixel_scale:
        raise InputError(f"ZERO={request.zero}: not of the size of {frames.name}: give frames of the same camera")
    captured = no_contact.pixels[: 1 << min(LARGEST_LOG2, len(no_contact.pixels).bit_length() - 1)]
    if frames.no_contact is not None and frames.reference is not None:
        rest = Rest.of(frames.reference[None])
        check_frames(no_contact, rest)
        check_zero(captured, rest, f"ZERO={request.zero}")
    return captured
