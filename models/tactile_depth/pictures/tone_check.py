# SPDX-License-Identifier: Apache-2.0
"""Check of a reference for another gamma, brightness, contrast or saturation of the camera, and for stray light."""

from __future__ import annotations

import numpy as np

from tactile_depth.base.errors import Part
from tactile_depth.pictures.doubts import Doubt, doubt
from tactile_depth.sensor.sensor import UNTOUCHED_AREAS, equal_areas

# RMS of log(reference / calibration's picture) that a quadratic in the position leaves for each colour, and the part
# of it that remains with functions of the levels. Gamma of 0.9 or 1.1, 4 levels brighter, contrast or saturation of 1.1
# or 0.9 (heights off by 5 % and more): 0.0027 and more, of which 0.5 at most remain, 0.0024 at most. Right, in other
# light, with noise, as JPEG, with a dent: 0.94 and more; a drawn picture whose noise is doubled: 0.0023. Gamma of 1.05,
# of which 0.74 remain, and 2 levels more or less, 0.0014, are not told from them.
CHANGED, REMAINS, LEFT = 0.0025, 0.58, 0.006
# The part of larger changes, which leave more: 20 to 40 levels darker, video range expanded twice, contrast of 1.2 to
# 1.4, 0.28 at most; 360 drawn specimens: 0.36 and more, and beyond `LEFT`.
EXPLAINED = 0.32
# The part that remains with light that is added, and changes evenly across the picture, as daylight that comes in. 8 or
# 16 levels at one side, none at the other, presses too (heights 5 to 20 % too low): 0.47 at most; 4 levels: 0.60 and
# more, 2 %. Right, as above, and in light that changes across the picture: 0.78 and more; 200 drawn specimens: 0.62 and
# more.
STRAY_REMAINS = 0.55
DARK = 60  # grey levels: a darker area counts less, as a level more or less changes its logarithm more


def other_tone(reference: np.ndarray, untouched: np.ndarray, name: Part) -> list[Doubt]:
    """Doubt a reference that is the calibration's picture with other levels, or with light added, beside a factor.

    Parameters
    ----------
    reference : array (rows, columns, 3)
    untouched : array (`UNTOUCHED_AREAS`, 3)
    """
    by_light, by_tone, by_stray = _left_by(equal_areas(reference), untouched)
    is_tone = by_tone < max(EXPLAINED * by_light, min(REMAINS * by_light, LEFT))
    if by_light < CHANGED:
        return []
    if by_stray < STRAY_REMAINS * by_light and not is_tone:
        text = ": light falls in from a side that the calibration did not have"
        return [doubt("stray light", name, text, remedy="shade the sensor, or calibrate again in this light")]
    if not is_tone:
        return []
    text = ": by its colours the camera has another gamma, brightness, contrast or saturation than in the calibration"
    return [doubt("tone", name, text, remedy="set the camera as for the calibration, or calibrate again")]


def _left_by(areas: np.ndarray, untouched: np.ndarray) -> list[float]:
    """Return what a quadratic in the position leaves of log(areas / untouched): by itself, with functions of the
    levels, and with added light."""
    own, seen = (np.maximum(each, 1).astype(np.float64).reshape(-1, 3) for each in (untouched, areas))
    change, weights = np.log(seen / own), np.minimum(np.minimum(seen, own), DARK)
    weights /= np.sqrt((weights**2).mean(axis=0))
    y, x = (axis.ravel() for axis in np.meshgrid(*(np.linspace(-1, 1, n) for n in UNTOUCHED_AREAS), indexing="ij"))
    light = np.stack((np.ones_like(x), x, y, x * x, x * y, y * y), axis=1)
    left = np.zeros(3)
    for colour in range(3):
        levels = own[:, colour, None]
        others = np.delete(own, colour, axis=1)
        tone = np.concatenate((light, np.log(levels), 1 / levels, others / levels), axis=1)
        weight = weights[:, colour, None]
        values = weight[:, 0] * change[:, colour]
        stray = np.concatenate((light, light[:, :3] / levels), axis=1)
        left += [_left(weight * terms, values) / 3 for terms in (light, tone, stray)]
    return [float(each) for each in np.sqrt(left)]


def _left(terms: np.ndarray, values: np.ndarray) -> float:
    """Return the mean square of what the least squares of terms (values, n) leave."""
    return float(((values - terms @ np.linalg.lstsq(terms, values, rcond=None)[0]) ** 2).mean())
