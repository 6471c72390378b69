# SPDX-License-Identifier: Apache-2.0
"""Frames of a device's own camera: what its flags and its depth say of pictures that the host does not see."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from tactile_depth.chip.contact.frame_flags import FrameFlags
from tactile_depth.chip.gradient.flat_field import PixelGains
from tactile_depth.chip.limits import LIGHT_GAIN
from tactile_depth.chip.link.depth_formats import FORMATS, received
from tactile_depth.depth.pipeline import Pipeline
from tactile_depth.device.frame import DeviceFrame, errors_of
from tactile_depth.pictures.doubts import LIGHT, TAKE_ANOTHER, Doubt, Warned, doubt, percents, tell, unexplained
from tactile_depth.pictures.light_check import clipped_depth, least_clipped, pressed_out
from tactile_depth.pictures.picture_check import LOST_SHARE

LEAST_GAIN, LARGEST_GAIN = 1 << LIGHT_GAIN.width - 2, (1 << LIGHT_GAIN.width) - 1


def dead_pixels(gains: PixelGains | None) -> int:
    """Return the pixels that are dark in every frame, because the reference is."""
    return 0 if gains is None else int(np.count_nonzero(gains.dead))


def of_camera(
    frame: DeviceFrame, shift: int, twin: Pipeline, known: tuple[Doubt, ...], dead: int, warned: Warned
) -> DeviceFrame:
    """Return a frame of a device's camera with what is known of it, and warn of what is new.

    Parameters
    ----------
    shift : int
        Bits that the format of the frame drops.
    twin : Pipeline
        With what the device holds.
    known : tuple of Doubt
        Of all frames, which have been told.
    dead : int
        Pixels for which the device's reference is too dark.
    """
    doubts = unexplained(_doubts_of(frame, shift, twin, dead), known)
    tell(warned.new(doubts))
    gains = frame.flags.light_gains
    light_gains = np.array(gains) * LIGHT_GAIN.lsb if any(gains) else None
    return replace(frame, warnings=tuple(map(str, (*known, *doubts))), light_gains=light_gains)


def _doubts_of(frame: DeviceFrame, shift: int, twin: Pipeline, dead: int) -> list[Doubt]:
    flags, name = frame.flags, f"frame {frame.number}"
    doubts = [*errors_of(frame), *_light(flags, name)]
    if flags.resumed:
        text = ": pixels before it were dropped, as of a picture that was not whole"
        doubts.append(doubt("resumed", name, text, remedy="see status(): its `input` says what comes"))
    if (dark := (flags.dark - dead) / math.prod(frame.grid)) > LOST_SHARE:
        text = f": {100 * dark:.0f} % of its pixels are black, which reads as flat gel"
        doubts.append(doubt("black", name, text, remedy="switch the lights on, and let nothing cover the camera"))
    if flags.colours_clipped or flags.depth_clipped or flags.zero_clipped:
        clipped = int(np.count_nonzero(np.abs(frame.codes) >= _least_clipped(frame, shift, twin)))
        doubts += [clipped_depth(clipped, name)] * bool(clipped)
    return doubts or pressed_out(frame.depth_mm, frame.untouched_mm, frame.threshold_mm, name)


def _light(flags: FrameFlags, name: str) -> list[Doubt]:
    """Doubt a frame whose light the gains do not undo."""
    gains, text = np.array(flags.light_gains), ": its light differs from that of the reference"
    if any(gains) and (gains.min() <= LEAST_GAIN or gains.max() == LARGEST_GAIN):
        text += f" by {percents(1 / (gains * LIGHT_GAIN.lsb) - 1)} or more, and the light gains do not undo it"
    elif flags.light_moves:
        text += ", and the light gains do not undo it yet"
    else:
        return []
    return [doubt(LIGHT, name, text, remedy=TAKE_ANOTHER)]


def _least_clipped(frame: DeviceFrame, shift: int, twin: Pipeline) -> int:
    """Return what a clipped depth code is at least, as the format of the frame has it."""
    width = twin.config.depth.width
    code = np.full((2, 2), least_clipped(width, twin.zero_codes), np.int32)
    return int(received(code, FORMATS[frame.depth_format], width, shift, bottom_first=False)[0, 0])
