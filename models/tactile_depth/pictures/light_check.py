# SPDX-License-Identifier: Apache-2.0
"""Check of the light of a picture after the light gains, and of its depth."""

from __future__ import annotations

import numpy as np

from tactile_depth.base.errors import Part
from tactile_depth.pictures.blocks import largest, medians, smooth, spread
from tactile_depth.pictures.doubts import LIGHT, TAKE_ANOTHER, Doubt, doubt, percents
from tactile_depth.pictures.picture_check import Checked

# Change of the light across the picture, 5th to 95th percentile of a plane and of a quadratic in the position, fitted
# to what nothing touches. Plane, right: 0.012 at most, as JPEG of quality 50 0.021; 2 % up at one side and down at the
# other, in one colour or in all: 0.032 and more. Quadratic, right: 0.020 at most, as JPEG of quality 50 0.040; a
# vignette of 5 %: 0.062 and more. A fit counts if enough blocks are near it: right 0.80 and more of them, with presses
# twice as large 0.5; of less, untouched gel and contact are not told apart.
PLANE, QUADRATIC = 0.025, 0.05
NEAR, NEAR_SHARE = 0.025, 0.6
# Light that the gains leave, median over the picture. Right, also in other light: 0.006 at most; without light gains in
# the light of the reference 0.018; without light gains in 5 % more or less light: 0.046 and more.
UNCOMPENSATED = 0.03
# Lowest height of 99.5 % of the pixels over the peak, if it is below -2 thresholds. Right: -0.42 at worst, with the
# model `lut` -0.65; press and reference exchanged: -0.97 and beyond.
PRESSED_OUT = 0.75


def doubts_of(
    checked: Checked, gains: np.ndarray | None, depth_mm: np.ndarray, threshold_mm: float
) -> tuple[Doubt, ...]:
    """Return why the heights of a picture are uncertain.

    Parameters
    ----------
    gains : float64 array (3,) or None
        Light gains of the picture.
    depth_mm : float64 array (rows, columns)
    threshold_mm : float
        Depth above which a pixel touches.
    """
    name, doubts = checked.name, list(checked.doubts)
    if checked.ratios is not None and not any(each.kind == "pattern" for each in doubts):
        doubts += _other_light(checked.ratios, gains, name)
    if not doubts:  # other light explains gel that stands out
        doubts += _pressed_out(depth_mm, threshold_mm, name)
    return tuple(doubts)


def _pressed_out(depth_mm: np.ndarray, threshold_mm: float, name: Part) -> list[Doubt]:
    """Doubt a picture whose gel stands out of the untouched surface by as much as it is pressed in."""
    some = depth_mm[::2, ::2].ravel()
    untouched = some[some <= threshold_mm]
    if not untouched.size:
        return []
    at_rest, rank = float(untouched.mean()), len(some) // 200
    lowest, peak = float(np.partition(some, rank)[rank]) - at_rest, float(some.max()) - at_rest
    if lowest >= -max(2 * threshold_mm, PRESSED_OUT * peak):
        return []
    text = f": its gel stands out by {-lowest:.2f} mm, as if something touched it in the reference"
    return [doubt("pressed out", name, text, remedy=TAKE_ANOTHER)]


def _other_light(ratios: np.ndarray, gains: np.ndarray | None, name: Part) -> list[Doubt]:
    """Doubt a picture whose light changes across it, or is not that of its reference after the light gains."""
    light = medians(ratios)
    rows, columns = (length // 2 * 2 for length in ratios.shape[:2])
    coarse = (ratios[:rows:2] + ratios[1:rows:2])[:, :columns]
    coarse = (coarse[:, ::2] + coarse[:, 1::2]) / (4 * light)
    change = _uneven(np.log(np.maximum(coarse, 0.05)))
    if change is not None:
        text = f": its light changes across it by {percents(change, '')} against the reference"
        return [doubt("uneven light", name, text, remedy=TAKE_ANOTHER)]
    if np.abs(light * (1 if gains is None else gains) - 1).max() > UNCOMPENSATED:
        why = "there are no light gains" if gains is None else "the light gains do not undo it"
        text = f": its light differs from that of the reference by {percents(light - 1)}, and {why}"
        return [doubt(LIGHT, name, text, remedy=TAKE_ANOTHER)]
    return []


def _uneven(difference: np.ndarray) -> np.ndarray | None:
    """Return how much each colour of untouched gel changes across the picture, (3,); None for little."""
    for degree, limit in ((2, QUADRATIC), (1, PLANE)):
        surface = smooth(difference, degree, rounds=4)
        change = spread(surface, 0.05)
        if change.max() < PLANE:  # a quadratic that changes so little leaves no plane that changes more
            return None
        near = float((largest(np.abs(difference - surface)) < NEAR).mean())
        if change.max() > limit and near > NEAR_SHARE:
            return change
    return None
