# SPDX-License-Identifier: Apache-2.0
"""Check of a reference for another gamma, brightness, contrast or saturation of the camera than the calibration's."""

from __future__ import annotations

import numpy as np

from tactile_depth.base.errors import Part
from tactile_depth.pictures.doubts import Doubt, doubt
from tactile_depth.sensor.sensor import UNTOUCHED_AREAS, equal_areas

# RMS of log(reference / calibration's picture) that a quadratic in the position leaves for each colour, and the share
# of it that remains with functions of the levels. Gamma of 0.9 or 1.1, 4 levels brighter, contrast or saturation of
# 1.1 or 0.9 (heights off by 5 % and more): 0.0032 and more, of which 0.52 at most remain, 0.003 at most. Right, in
# other light, with noise, as JPEG, with a dent: 0.89 and more; another specimen: 0.64 and more, 0.0107 and more.
CHANGED, REMAINS, LEFT = 0.003, 0.58, 0.006


def other_tone(reference: np.ndarray, untouched: np.ndarray, name: Part) -> list[Doubt]:
    """Doubt a reference whose levels are a function of those of the calibration's picture other than a factor.

    Parameters
    ----------
    reference : array (rows, columns, 3)
    untouched : array (`UNTOUCHED_AREAS`, 3)
    """
    own = np.maximum(untouched, 1).astype(np.float64).reshape(-1, 3)
    change = np.log(np.maximum(equal_areas(reference), 1).reshape(-1, 3) / own)
    y, x = (axis.ravel() for axis in np.meshgrid(*(np.linspace(-1, 1, n) for n in UNTOUCHED_AREAS), indexing="ij"))
    light = np.stack((np.ones_like(x), x, y, x * x, x * y, y * y), axis=1)
    by_light = by_tone = 0.0
    for colour in range(3):
        levels = own[:, colour, None]
        others = np.delete(own, colour, axis=1)
        tone = np.concatenate((light, np.log(levels), 1 / levels, others / levels), axis=1)
        by_light += _left(light, change[:, colour]) / 3
        by_tone += _left(tone, change[:, colour]) / 3
    if by_light < CHANGED**2 or by_tone > min(REMAINS**2 * by_light, LEFT**2):
        return []
    text = ": by its colours the camera has another gamma, brightness, contrast or saturation than in the calibration"
    return [doubt("tone", name, text, remedy="set the camera as for the calibration, or calibrate again")]


def _left(terms: np.ndarray, values: np.ndarray) -> float:
    """Return the mean square of what the least squares of terms (values, n) leave."""
    return float(((values - terms @ np.linalg.lstsq(terms, values, rcond=None)[0]) ** 2).mean())
