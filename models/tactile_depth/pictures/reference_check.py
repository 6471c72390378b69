# SPDX-License-Identifier: Apache-2.0
"""Check of a reference: its frames agree, nothing touches in it, and it has the lighting of the calibration."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import uniform_filter

from tactile_depth.base.errors import Argument, Part
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.resampling import WHOLE, Share
from tactile_depth.pictures.blocks import Rest, block_means, differences, largest, medians, smooth
from tactile_depth.pictures.doubts import (
    CLIPPED,
    REFERENCE,
    TAKE_ANOTHER,
    TOUCHED,
    Doubt,
    UnusablePicture,
    clip_levels,
    clipped,
    doubt,
    percents,
    tell,
)
from tactile_depth.pictures.exchanges import CORRECT_IT, DARKEST, exchange_of
from tactile_depth.pictures.light_check import changed_at_rest
from tactile_depth.pictures.picture_check import is_grey, is_uneven
from tactile_depth.pictures.tone_check import other_tone
from tactile_depth.pictures.view_check import other_view
from tactile_depth.sensor.sensor import LIGHTING_AGREES, TOO_DARK, Sensor, equal_areas, lighting

# 99th percentile of the difference of the ratios of a reference's colours to polynomials of fifth degree, for a
# calibration without its own picture. Right, GelSight Mini: 0.047; with the contacts of presses 0.098 and more.
ROUGH, SMOOTH_DEGREE = 0.068, 5
# 99th percentile of log(reference / calibration's own picture), means of 3 x 3 areas, beyond polynomials of seventh
# degree: more than the first number and the second times its median, so that noise and another specimen are no contact.
# Right, Mini, DIGIT and drawn, in other light, with noise of 3 grey levels, as JPEG of quality 50: 3.6 medians beyond
# the first number at most; of 320 drawn specimens none is beyond the limit. Presses at 20 % of their depth, with noise
# of 2 grey levels: all (45 on a Mini, 14 on a DIGIT, 60 drawn), as JPEG of quality 90 43 of 45; at 10 %: 39 to 44.
DENT, DENT_OF_MEDIAN, DENT_DEGREE = 0.004, 9, 7
SMOOTH_SCALE = 0.01  # distance from the polynomials from which a value loses its weight
# The same of a zero offset, in mm. Right, GelSight Mini in light up to 11 % off across it, with noise of 3 grey levels,
# as JPEG of quality 50, five grids and models: 0.004 beyond 9 medians at most. Presses: 0.057 and more; at 20 % of
# their depth 93 of 115 are beyond the limit.
DENT_MM = 0.02
UNTOUCHED = "capture the zero offset with the gel untouched"
# Share of pixels with a colour below `TOO_DARK`, whose slopes are lost. Right: 0; in half of the light, presses too,
# 0.036, heights 1 % off; in 0.4 of it 0.09, and up to 20 % too low.
DARK = 0.06
STEADY = 0.05  # brightness of the frames of one reference, relative to their median


def check_reference(
    sensor: Sensor, pictures: np.ndarray, name: Part = REFERENCE, share: Share = WHOLE
) -> tuple[Doubt, ...]:
    """Check pictures without contact; warn of each doubt and return them.

    Parameters
    ----------
    pictures : uint8 array (frames, rows, columns, 3), RGB
        Of the sensor's camera. One that is too dark is refused later (`require_light`).
    share : Share
        Part of the pictures that the user gave that these are.

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
    rest = pictures.mean(axis=0, dtype=np.float32)
    levels = clip_levels(pictures) if is_uneven(blocks.mean(axis=0)) else (CLIPPED,) * 3
    doubts = [*clipped(pictures, name, levels), *_other_lighting(sensor, rest, name, share)]
    if (dark := float((rest.min(axis=-1) < TOO_DARK).mean())) > DARK:
        text = f": {100 * dark:.0f} % of it have a colour below {TOO_DARK} of 255, their slopes are lost"
        doubts.append(doubt("dark", name, text, remedy="take it and the pictures in more light"))
    doubts = doubts or _contact(sensor, rest, blocks.mean(axis=0), name)
    tell(doubts)
    return tuple(doubts)


def _contact(sensor: Sensor, rest: np.ndarray, blocks: np.ndarray, name: Part) -> list[Doubt]:
    """Doubt a reference, `rest` and its blocks, in which something touches."""
    if sensor.untouched is None:
        colours = np.log(blocks)
        colours -= colours.mean(axis=-1, keepdims=True)
        differs = float(np.percentile(largest(np.abs(colours - smooth(colours, SMOOTH_DEGREE))), 99))
        is_touched, of = differs > ROUGH, ""
    else:
        differs, is_touched = dents(equal_areas(rest), sensor.untouched)
        of = " from the calibration's own picture"
    if not is_touched:
        return []
    text = f": it is not smooth (differences of {100 * differs:.0f} %{of}), as if something touched the gel"
    return [doubt("contact in the reference", name, text, remedy=TAKE_ANOTHER)]


def earlier_zero(config: Configuration) -> tuple[Doubt, ...]:
    """Doubt a zero offset, if there is one, that was measured with another reference than the one in use."""
    remedy = "with the gel untouched call capture_zero()"
    return (doubt("earlier zero", "the zero offset is of the reference before", remedy=remedy),) * config.zero_offset


def check_zero(frames: np.ndarray, rest: Rest | None, name: Part) -> tuple[Doubt, ...]:
    """Check pictures for the zero offset; warn, and return a doubt, if they show another light or contact than `rest`.

    Parameters
    ----------
    frames : uint8 array (frames, rows, columns, 3)
        On the grid, as the reference `rest` is.
    """
    if rest is None:
        return ()
    mean = frames.mean(axis=0)
    differs, is_touched = dents(equal_areas(mean), equal_areas(rest.pixels))
    change = changed_at_rest(block_means(mean) / rest.blocks)
    if change is not None:
        text = f": their light changes across them by {percents(change, '')} against the reference, or their view does"
        found = doubt("light of the zero offset", name, text, remedy="capture the reference and the zero offset again")
    elif is_touched:
        text = f": differences of {100 * differs:.0f} % from the reference, as if something touched the gel"
        found = doubt(TOUCHED, name, text, remedy=UNTOUCHED)
    else:
        return ()
    tell([found])
    return (found,)


def check_zero_depth(depth_mm: np.ndarray, name: Part) -> tuple[Doubt, ...]:
    """Check a zero offset (rows, columns); warn, and return a doubt, if something touched the gel."""
    repeated = np.repeat(depth_mm[..., None], 3, axis=-1)
    rough = np.abs(repeated - smooth(repeated, DENT_DEGREE, rounds=6, scale=SMOOTH_SCALE))[..., 0]
    differs = float(np.percentile(rough, 99))
    if differs <= DENT_MM + DENT_OF_MEDIAN * float(np.median(rough)):
        return ()
    text = f": it is not smooth (differences of {differs:.2f} mm), as if something touched the gel"
    found = doubt(TOUCHED, name, text, remedy=UNTOUCHED)
    tell([found])
    return (found,)


def dents(areas: np.ndarray, own: np.ndarray) -> tuple[float, bool]:
    """Return how far a picture is from another of untouched gel, both in areas, and True for more than noise leaves."""
    ratios = np.log(np.maximum(areas, 1) / np.maximum(own, 1))
    ratios -= medians(ratios)
    left = ratios - smooth(ratios, DENT_DEGREE, rounds=6, scale=SMOOTH_SCALE)
    rough = largest(np.abs(uniform_filter(left, (3, 3, 0), mode="nearest")))
    differs = float(np.percentile(rough, 99))
    return differs, differs > DENT + DENT_OF_MEDIAN * float(np.median(rough))


def _other_lighting(sensor: Sensor, rest: np.ndarray, name: Part, share: Share) -> list[Doubt]:
    """Compare a reference with the lighting of the calibration; refuse another order of it."""
    if sensor.lighting is None:
        return []
    own, seen = np.maximum(sensor.lighting, DARKEST), np.maximum(lighting(rest), DARKEST)
    if is_grey(seen, own):
        raise UnusablePicture(name, ": it is grey, its colours do not differ", remedy="take it in colour, as RGB")
    exchange = exchange_of(sensor, rest)
    if sensor.untouched is not None and not exchange and (other := other_tone(rest, sensor.untouched, name)):
        return other
    if other := other_view(sensor, rest, name, share):
        return other
    if exchange:
        raise UnusablePicture(name, f": {exchange}, by the lighting of {sensor.name}", remedy=CORRECT_IT)
    differs = float(np.sqrt(((seen - own) ** 2).mean()))
    if differs > LIGHTING_AGREES:
        text = f": it does not look like the sensor of {sensor.name} (its lighting differs by {100 * differs:.0f} %)"
        remedy = ("give the ", Argument("calibration"), " of the sensor that took it")
        return [doubt("lighting", name, text, remedy=remedy)]
    return []
