# SPDX-License-Identifier: Apache-2.0
"""Check of the light of a picture after the light gains, and of its depth."""

from __future__ import annotations

import numpy as np

from tactile_depth.base.errors import Argument, Part
from tactile_depth.pictures.blocks import block_means, block_size, largest, medians, smooth, spread
from tactile_depth.pictures.doubts import LIGHT, TAKE_ANOTHER, Doubt, doubt, percents
from tactile_depth.pictures.exchanges import CORRECT_IT
from tactile_depth.pictures.picture_check import Checked

# Change of the light across the picture, 5th to 95th percentile of a plane and of a quadratic in the position, fitted
# to what nothing touches. Plane, right: 0.012 at most, with noise of 2 grey levels or as JPEG of quality 75 0.0125, of
# quality 60 0.019; 1 % up at one side and down at the other, in one colour or in all: median 0.017. Of 1,800 such
# presses, 53 are more than 5 % off, of which 9, beside the edge, are below the limit. Quadratic,
# right: 0.020 at most, as JPEG of quality 50 0.040; a vignette of 5 %: 0.062 and more. A fit counts if enough blocks
# are near it: right 0.80 and more, with presses twice as large 0.5; of less, gel and contact are not told apart.
PLANE, QUADRATIC = 0.014, 0.05
NEAR, NEAR_SHARE = 0.025, 0.6
# A larger change counts if fewer blocks are near. Right, with 0.4 and more near: 0.22 at most, presses enlarged 2.5
# times; colours of 1.3 times the saturation of the reference's: 0.33 and more, with 0.52 to 0.69 near.
GROSS, GROSS_NEAR_SHARE = 0.27, 0.4
# The same where no block is far from the fit: nothing touches, but depth is read. Largest distance, right, with noise
# of 3 grey levels 0.014, as JPEG of quality 75 0.034; presses 0.25 and more. Plane, right: 0.0016, as JPEG 0.0034;
# 0.5 % up at one side and down at the other: 0.0089 and more. Quadratic: 0.0029, as JPEG 0.0058.
UNTOUCHED, SLIGHT_PLANE, SLIGHT_QUADRATIC = 0.05, 0.0045, 0.01
# A slope changes the three colours apart, a shadow or a lamp alike: logarithm of the change of a block, and largest
# share of it by which the colours may differ. Share of such blocks, right, also with noise of 3 grey levels, as JPEG of
# quality 75, or presses enlarged: Mini 0.005, DIGIT 0.012 at most. A strip of a tenth at the right, times 0.9: Mini
# 0.042 and more, without contact 0.094; times 0.8: DIGIT 0.035 and more.
SHADE, ALIKE, SHADED = 0.05, 0.5, 0.02
# Pictures for the zero offset, in which nothing touches: largest change of a plane and of a quadratic. Right, with
# noise of 3 grey levels or as JPEG of quality 75: 0.0034 and 0.0058, of quality 50 0.0196. 1 % up at one side and down
# at the other: 0.023; moved by 2 of 320 pixels: 0.042; a vignette of 5 %: 0.036; zoomed by 0.98: 0.031; gamma of 1.1:
# 0.13.
AT_REST_LIMITS = {1: 0.014, 2: 0.027}
# Light that the gains leave, median over the picture. Right, also in other light: 0.006 at most; without light gains in
# the light of the reference 0.018; without light gains in 5 % more or less light: 0.046 and more.
UNCOMPENSATED = 0.03
# The same without light gains where no block is far from it: nothing touches, but depth is read. 2 % less light: a
# contact of 0.47 mm.
UNCOMPENSATED_AT_REST = 0.007
# Part of the slopes, of the sum of squares, that no surface has: g - grad z. Right: 0.15 at most, of presses
# enlarged 1.7 times and cut by the picture's edge 0.24, drawn contacts 0.003; drawn contacts with exchanged colours or
# mirrored sides 0.31 and more.
OF_NO_SURFACE = 0.27
# Lowest height of 99.5 % of the pixels over the peak, if it is below -2 thresholds. Right: -0.49 at worst, with the
# model `lut` -0.66; press and reference exchanged: -1.2 and beyond.
PRESSED_OUT = 0.75


def doubts_of(
    checked: Checked,
    gains: np.ndarray | None,
    depth_mm: np.ndarray,
    threshold_mm: float,
    slopes_mm: np.ndarray | None,
    clipped: int,
) -> tuple[Doubt, ...]:
    """Return why the heights of a picture are uncertain.

    Parameters
    ----------
    gains : float64 array (3,) or None
        Light gains of the picture.
    depth_mm : float64 array (rows, columns)
    threshold_mm : float
        Depth above which a pixel touches.
    slopes_mm : float64 array (rows, columns, 2) or None
        Change of depth from a pixel to the next, in mm; None where the depth is held at the edges.
    clipped : int
        Clipped depths. Their slopes are those of no surface.
    """
    name, doubts = checked.name, list(checked.doubts)
    if checked.ratios is not None and not any(each.kind == "pattern" for each in doubts):
        doubts += _other_light(checked.ratios, gains, bool(depth_mm.max() > threshold_mm), name)
    if doubts:  # other light explains gel that stands out
        return tuple(doubts)
    lowest, peak = _range(depth_mm)
    if peak - lowest > 2 * threshold_mm:
        if slopes_mm is not None and not clipped:
            doubts += _no_surface(depth_mm, slopes_mm, name)
            if doubts and gains is not None and checked.ratios is not None and _far(checked.ratios).max() < UNTOUCHED:
                text = ": nothing touches, its depth is of light gains that have not followed yet"
                doubts = [doubt(LIGHT, name, text, remedy="leave it out: they follow within some pictures")]
        if not doubts:
            doubts += pressed_out(depth_mm, _at_rest(depth_mm, checked.ratios), threshold_mm, name)
    if clipped and not doubts:
        doubts.append(clipped_depth(clipped, name))
    return tuple(doubts)


def _range(depth_mm: np.ndarray) -> tuple[float, float]:
    """Return the lowest depth of 99.5 % of the pixels, and the largest."""
    some = depth_mm[::2, ::2].ravel()
    rank = len(some) // 200
    return float(np.partition(some, rank)[rank]), float(some.max())


def _no_surface(depth_mm: np.ndarray, slopes_mm: np.ndarray, name: Part) -> list[Doubt]:
    """Doubt a picture whose slopes are those of no surface."""
    slopes = block_means(slopes_mm[:-1, :-1])
    rows, columns = slopes.shape[:2]
    height, width = block_size(depth_mm.shape[0] - 1, depth_mm.shape[1] - 1)
    # The mean of differences over a block is the difference of its far and near edge.
    across = depth_mm[: rows * height, : columns * width + 1 : width].reshape(rows, height, columns + 1).mean(axis=1)
    down = depth_mm[: rows * height + 1 : height, : columns * width].reshape(rows + 1, columns, width).mean(axis=2)
    left = slopes - np.stack((np.diff(across, axis=1) / width, np.diff(down, axis=0) / height), axis=-1)
    share = float((left**2).sum() / (slopes**2).sum())
    if share <= OF_NO_SURFACE:
        return []
    text = f": {100 * share:.0f} % of its slopes belong to no surface: colours exchanged, sides mirrored, or new light"
    return [doubt("no surface", name, text, remedy=CORRECT_IT)]


def _at_rest(depth_mm: np.ndarray, ratios: np.ndarray | None) -> float:
    """Return the depth of gel that has the colour of the reference."""
    if ratios is None:
        return float(np.median(depth_mm))
    rows, columns = ((np.arange(n) + 0.5) / n for n in ratios.shape[:2])
    height, width = depth_mm.shape
    middles = depth_mm[(rows * height).astype(int)[:, None], (columns * width).astype(int)]
    near = _far(ratios) < NEAR
    return float(np.median(middles[near] if near.any() else middles))


def _far(ratios: np.ndarray) -> np.ndarray:
    """Return how far blocks are from the colour of the reference, after a gain for each colour: the largest."""
    return largest(np.abs(ratios / medians(ratios) - 1))


def pressed_out(depth_mm: np.ndarray, at_rest_mm: float, threshold_mm: float, name: Part) -> list[Doubt]:
    """Doubt a picture whose gel stands out of the untouched surface by as much as it is pressed in."""
    lowest, peak = _range(depth_mm)
    if not lowest - at_rest_mm < -max(2 * threshold_mm, PRESSED_OUT * (peak - at_rest_mm)):
        return []
    text = f": its gel stands out by {at_rest_mm - lowest:.2f} mm, as if something touched it in the reference"
    return [doubt("pressed out", name, text, remedy=TAKE_ANOTHER)]


def least_clipped(width: int, zero: np.ndarray) -> int:
    """Return what a clipped depth code of so many bits is at least, either way, less the zero offset."""
    return (1 << width - 1) - 1 - int(np.abs(zero).max())


def clipped_depth(count: int, name: Part) -> Doubt:
    """Return the doubt of a picture with clipped depths."""
    text, larger = f": {count} of its depths clipped", ("give a larger ", Argument("depth_range_mm"))
    return doubt("clipped depth", name, f"{text}, heights there are too small", remedy=larger)


def _other_light(ratios: np.ndarray, gains: np.ndarray | None, touches: bool, name: Part) -> list[Doubt]:
    """Doubt a picture whose light changes across it, or is not that of its reference after the light gains."""
    light, change = medians(ratios), _uneven(_difference(ratios), touches)
    if change is not None:
        text = f": its light changes across it by {percents(change, '')} against the reference"
        return [doubt("uneven light", name, text, remedy=TAKE_ANOTHER)]
    if (share := shaded(ratios)) > SHADED:
        text = f": {100 * share:.0f} % of it is darker or brighter than its reference in all colours alike"
        return [doubt("uneven light", name, text, remedy=("keep shadows and lamps away, or ", *TAKE_ANOTHER))]
    is_at_rest = gains is None and touches and _far(ratios).max() < UNTOUCHED
    limit = UNCOMPENSATED_AT_REST if is_at_rest else UNCOMPENSATED
    if np.abs(light * (1 if gains is None else gains) - 1).max() > limit:
        why = "there are no light gains" if gains is None else "the light gains do not undo it"
        text = f": its light differs from that of the reference by {percents(light - 1)}, and {why}"
        return [doubt(LIGHT, name, text, remedy=TAKE_ANOTHER)]
    return []


def _difference(ratios: np.ndarray) -> np.ndarray:
    """Return log(picture / reference) of blocks twice as large, after a gain for each colour."""
    rows, columns = (length // 2 * 2 for length in ratios.shape[:2])
    coarse = (ratios[:rows:2] + ratios[1:rows:2])[:, :columns]
    coarse = (coarse[:, ::2] + coarse[:, 1::2]) / (4 * medians(ratios))
    return np.log(np.maximum(coarse, 0.05))


def shaded(ratios: np.ndarray) -> float:
    """Return the share of blocks whose colours change alike, as in a shadow."""
    change = np.log(np.maximum(ratios / medians(ratios), 0.01))
    mean, apart = change.mean(axis=-1), change.max(axis=-1) - change.min(axis=-1)
    return float((np.abs(mean) > np.maximum(SHADE, apart / ALIKE)).mean())


def changed_at_rest(ratios: np.ndarray) -> np.ndarray | None:
    """Return how much the light of a picture without contact changes across it, (3,); None for little."""
    difference = _difference(ratios)
    changes = {degree: spread(smooth(difference, degree, rounds=4), 0.05) for degree in AT_REST_LIMITS}
    return next((change for degree, change in changes.items() if change.max() > AT_REST_LIMITS[degree]), None)


def _uneven(difference: np.ndarray, touches: bool) -> np.ndarray | None:
    """Return how much each colour of untouched gel changes across the picture, (3,); None for little."""
    for degree, limit, slight in ((2, QUADRATIC, SLIGHT_QUADRATIC), (1, PLANE, SLIGHT_PLANE)):
        surface = smooth(difference, degree, rounds=4)
        change, off = spread(surface, 0.05), largest(np.abs(difference - surface))
        untouched = touches and off.max() < UNTOUCHED
        if change.max() < (SLIGHT_PLANE if untouched else PLANE):  # a quadratic so small leaves no plane that is larger
            return None
        is_sure = untouched or float((off < NEAR).mean()) > (GROSS_NEAR_SHARE if change.max() > GROSS else NEAR_SHARE)
        if change.max() > (slight if untouched else limit) and is_sure:
            return change
    return None
