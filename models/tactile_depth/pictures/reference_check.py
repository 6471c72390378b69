# SPDX-License-Identifier: Apache-2.0
"""Check of a reference: its frames agree, it is smooth, and it has the lighting of the calibration."""

from __future__ import annotations

import numpy as np

from tactile_depth.base.errors import Argument, Part
from tactile_depth.pictures.blocks import block_means, differences, smooth
from tactile_depth.pictures.doubts import REFERENCE, TAKE_ANOTHER, Doubt, UnusablePicture, clipped, doubt, tell
from tactile_depth.pictures.exchanges import CORRECT_IT, DARKEST, exchange_of
from tactile_depth.pictures.picture_check import is_grey
from tactile_depth.sensor.sensor import LIGHTING_AGREES, TOO_DARK, Sensor, lighting

# 99th percentile of the difference of the ratios of a reference's colours to polynomials of fifth degree. Right: 0.047;
# with the contacts of presses 0.098 and more.
ROUGH, SMOOTH_DEGREE = 0.068, 5
STEADY = 0.05  # brightness of the frames of one reference, relative to their median


def check_reference(sensor: Sensor, pictures: np.ndarray, name: Part = REFERENCE) -> tuple[Doubt, ...]:
    """Check pictures without contact; warn of each doubt and return them.

    Parameters
    ----------
    pictures : uint8 array (frames, rows, columns, 3), RGB
        Full pictures of the sensor's camera. One that is too dark is refused later (`require_light`).

    Raises
    ------
    UnusablePicture
    """
    brightness = pictures.mean(axis=(1, 2, 3))
    usual = float(np.median(brightness))
    for index in np.flatnonzero(np.abs(brightness - usual) > STEADY * usual + 1):
        problem = f": picture {index} is {100 * (brightness[index] / max(usual, 1) - 1):+.0f} % as bright as the others"
        raise UnusablePicture(name, problem, remedy="take all in the same light, after the exposure has settled")
    if usual < TOO_DARK:
        return ()
    blocks = np.maximum([block_means(picture) for picture in pictures], 1)
    for number, each in enumerate(blocks):
        differs = np.abs(differences(each, np.median(blocks, axis=0))).max(axis=-1)
        if np.percentile(differs, 99) > ROUGH:
            problem = f": picture {number} differs from the others by {100 * differs.max():.0f} %, as if touched"
            raise UnusablePicture(name, problem, remedy="take all with the sensor untouched")
    doubts = [*clipped(pictures, name), *_other_lighting(sensor, pictures.mean(axis=0, dtype=np.float32), name)]
    colours = np.log(blocks.mean(axis=0))
    colours -= colours.mean(axis=-1, keepdims=True)
    rough = float(np.percentile(np.abs(colours - smooth(colours, SMOOTH_DEGREE)).max(axis=-1), 99))
    if rough > ROUGH and not doubts:
        text = f": it is not smooth (differences of {100 * rough:.0f} %), as if something touched the gel"
        doubts.append(doubt("contact in the reference", name, text, remedy=TAKE_ANOTHER))
    tell(doubts)
    return tuple(doubts)


def _other_lighting(sensor: Sensor, rest: np.ndarray, name: Part) -> list[Doubt]:
    """Compare a reference with the lighting of the calibration; refuse another order of it."""
    if sensor.lighting is None:
        return []
    own, seen = np.maximum(sensor.lighting, DARKEST), np.maximum(lighting(rest), DARKEST)
    if is_grey(seen, own):
        raise UnusablePicture(name, ": it is grey, its colours do not differ", remedy="take it in colour, as RGB")
    if exchange := exchange_of(sensor, rest):
        raise UnusablePicture(name, f": {exchange}, by the lighting of {sensor.name}", remedy=CORRECT_IT)
    differs = float(np.sqrt(((seen - own) ** 2).mean()))
    if differs > LIGHTING_AGREES:
        text = f": it does not look like the sensor of {sensor.name} (its lighting differs by {100 * differs:.0f} %)"
        remedy = ("give the ", Argument("calibration"), " of the sensor that took it")
        return [doubt("lighting", name, text, remedy=remedy)]
    return []
