# SPDX-License-Identifier: Apache-2.0
"""Check of a picture with its reference: light, colours, order of colours and sides, rows that are whole."""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np

from tactile_depth.base.errors import Part
from tactile_depth.pictures.blocks import (
    RIDGE,
    Rest,
    block_means,
    differences,
    largest,
    median,
    medians,
    smooth,
    spread,
)
from tactile_depth.pictures.doubts import COLOURS, Doubt, UnusablePicture, clip_levels, clipped, doubt
from tactile_depth.pictures.exchanges import CORRECT_IT, nearest_exchange, pattern
from tactile_depth.sensor.scenes import REST
from tactile_depth.sensor.sensor import TOO_DARK

# Weakest colour over the strongest, each relative to the reference. Right: 0.98 and more, 5 % off in two colours 0.89
# and more; a colour that is lost: 0.
LOST_COLOUR = 0.25
# Brightest colour of a block over the reference, in the light of the strongest colour. Right: 0.67 and more; not lit or
# not sent: 0. Share of such blocks that is refused.
LOST_BLOCK, LOST_SHARE = 0.25, 0.02
# Spread of the ratio of two colours over the picture, without a tenth at both ends, natural logarithm. Right: 0.85 and
# more; a grey picture: 0.00. A reference that spreads less than the second number is grey itself.
GREY, COLOURED = 0.02, 0.08
# Median difference to the pattern of the reference. Right: 0.005 at most; exchanged, mirrored, rotated: 0.039 and more,
# and 0.005 at most after the right exchange. An exchange is named where it leaves less than half of the difference, and
# less than half of this limit.
PATTERN_DIFFERS, EXCHANGE_LEAVES = 0.02, 0.5
PATTERN_DOUBTFUL = 0.04
# The same of one of `BANDS` bands of rows. Right: 0.010 at most; torn by 20 pixels: 0.059 and more, by 40: 0.11 and
# more.
BAND_DIFFERS, BANDS = 0.02, 8
# Zoom of a picture against its reference, by its light: logarithms of the shares of the width and height that it shows,
# and the part of the median difference that these leave. Right, as JPEG of quality 50, presses enlarged 2.5 times:
# 0.021 at most, 0.87 and more; a vignette of 6 %: 0.05, 0.53 and more. Zoomed by 0.95 to 0.8, or one axis alone: 0.052
# and more, 0.46 at most, of which 0.019 at most is left; torn 0.028 and more. Heights are off by about twice the zoom.
ZOOMED, ZOOM_DIFFERS, ZOOM_LEAVES = 0.02, 0.003, (0.5, 0.024)
ZOOM_ROUNDS, ZOOM_SCALE = 6, 0.012  # of weights, and the distance from which a value loses its own
# Step from a row of blocks to the second next, of the most different colour, exceeded in three quarters of the columns.
# Right: 0.014 at most, with light that changes by 30 % 0.012; torn by 20 pixels 0.059 and more, by 40 0.097 and more.
SEAM = 0.04
# The same from which the rows below may be those of a damaged file: JPEG with a flipped bit, peaks 2 to 5 times too
# large: 0.5 and more.
CAST = 0.1

# Colours of a picture of a real sensor: 25,000 and more, as JPEG of quality 15 500 and more. Reduced to a palette, with
# the reference or without: heights 6 to 40 % too low. Pixels below which a picture may have so few, and of which some
# are counted first.
PALETTE, LEAST_PIXELS = 256, 1024
# Without a reference the untouched gel has the drawn sensor's colour, in so many levels. Share of such blocks: of drawn
# contacts 0.45 and more, of a real sensor's pictures 0.
AT_REST, REST_SHARE = 6, 0.05

COMPLETE = "give frames that are complete"
OTHER_SENSOR = "touch less of the gel, or take the reference with the same sensor"


class Checked(NamedTuple):
    """A picture that was not refused.

    Attributes
    ----------
    ratios : float32 array (block rows, block columns, 3) or None
        Picture over reference; None without a reference.
    doubts : list of Doubt
        Those that need no depth.
    """

    name: Part
    ratios: np.ndarray | None
    doubts: list[Doubt]


def check_picture(picture: np.ndarray, rest: Rest | None, name: Part) -> Checked:
    """Refuse a picture that gives no right depth.

    Parameters
    ----------
    picture : uint8 array (rows, columns, 3)
        On the grid, as the reference is.

    Raises
    ------
    UnusablePicture
    """
    blocks = block_means(picture)
    if blocks.max() < TOO_DARK:
        problem = f": it is black, at most {blocks.max():.0f} of 255"
        raise UnusablePicture(name, problem, remedy="take it with the lights on, and leave out a camera's first frames")
    doubts = clipped(picture[None], name)
    if rest is None:
        return Checked(name, None, doubts + _of_real_sensor(blocks, name))
    ratios = blocks / rest.blocks
    light = medians(ratios)
    constant = spread(blocks, 0.0) < 1
    if constant.any():  # those of the reference are not
        constant &= spread(rest.blocks, 0.0) > COLOURED * rest.blocks.mean()
    if constant.all():
        raise UnusablePicture(name, ": it has one colour everywhere", remedy=COMPLETE)
    lost = (light < LOST_COLOUR * light.max()) | constant
    if lost.any():
        problem = f": it has no {' and no '.join(itertools.compress(COLOURS, lost))}"
        raise UnusablePicture(name, problem, remedy="look at the camera's format and at the lamps")
    dark = float((largest(ratios) < LOST_BLOCK * light.max()).mean())
    if dark > LOST_SHARE:
        raise UnusablePicture(name, f": {100 * dark:.0f} % of it are dark", remedy=COMPLETE)
    if is_grey(blocks, rest.blocks):
        raise UnusablePicture(name, ": it is grey, its colours do not differ", remedy="give it in colour, as RGB")
    _require_all_rows(picture, rest, light, name)
    if is_uneven(rest.blocks):  # else a flat facet has one level too
        doubts = clipped(picture[None], name, clip_levels(picture))
    return Checked(name, ratios, doubts + _other_pattern(blocks, rest.blocks, name))


def require_all_colours(picture: np.ndarray, untouched: np.ndarray, name: Part) -> None:
    """Refuse a picture of a real sensor, (rows, columns, 3), that has no more colours than a palette.

    One with as many colours as levels, such as a grey one, and a dark one are refused elsewhere.
    """
    pixels = picture.reshape(-1, 3)
    if len(pixels) < LEAST_PIXELS or _colours(pixels[:: len(pixels) // LEAST_PIXELS]) > PALETTE:
        return
    if pixels.mean() < TOO_DARK:
        return
    colours = _colours(pixels)
    if max(len(np.unique(levels)) for levels in pixels.T) < colours <= PALETTE and is_uneven(block_means(untouched)):
        problem = f": it has {colours} colours in all, as if reduced to a palette"
        raise UnusablePicture(name, problem, remedy="save what the camera sends as PNG, with all its colours")


def _colours(pixels: np.ndarray) -> int:
    """Return how many colours pixels (pixels, 3) have."""
    return len(np.unique(pixels @ np.array([1 << 16, 1 << 8, 1], np.uint32)))


def _of_real_sensor(blocks: np.ndarray, name: Part) -> list[Doubt]:
    """Doubt a picture, by its blocks, that is none of the drawn sensor."""
    if (largest(np.abs(blocks - REST)) < AT_REST).mean() >= REST_SHARE:
        return []
    remedy = "give the calibration and a reference of the sensor that took it"
    return [doubt("pattern", name, ": it does not look like one of the synthetic sensor", remedy=remedy)]


def is_uneven(rest: np.ndarray) -> bool:
    """Return True if the light of untouched gel, by its blocks, differs across it, as that of a real sensor does."""
    return bool((spread(rest, 0.1) > COLOURED * rest.mean()).any())


def is_grey(blocks: np.ndarray, rest: np.ndarray) -> bool:
    """Return True if the colours of a picture are in one ratio everywhere, and those of the reference are not."""

    def spread_of_ratios(of: np.ndarray) -> float:
        ratios = np.log(np.maximum(of, 0.01))
        return float(spread((ratios - ratios[..., 1:2])[..., ::2], 0.1).max())

    return spread_of_ratios(blocks) < GREY and spread_of_ratios(rest) > COLOURED


def _require_all_rows(picture: np.ndarray, rest: Rest, light: np.ndarray, name: Part) -> None:
    """Refuse a picture with many equal rows: a frame that stopped, or repeats a row.

    Rows of a drawn picture without noise may be equal: where nothing touches, or along a cylinder. They do not count.
    """
    rows = picture.reshape(len(picture), -1)
    equal = (rows[1:] == rows[:-1]).all(axis=1)
    if not equal.any():
        return
    least = max(3, len(picture) // 16)
    for first, end in np.flatnonzero(np.diff(np.concatenate(([0], equal, [0])))).reshape(-1, 2):
        if end - first < least:
            continue
        untouched = rest.pixels[first : end + 1]
        differs = np.abs(picture[first : end + 1] - untouched * light).mean(axis=(0, 1)).max()
        others = np.concatenate((equal[:first], equal[end:]))
        varies = np.ptp(untouched, axis=0).max() > 2 or (len(others) >= least and others.mean() < 0.1)
        if differs > 2 and varies:
            problem = f": {100 * (end - first + 1) / len(picture):.0f} % of its rows are one row, repeated"
            raise UnusablePicture(name, problem, remedy=COMPLETE)


def _other_pattern(blocks: np.ndarray, rest: np.ndarray, name: Part) -> list[Doubt]:
    """Refuse a picture whose pattern of light is that of the reference in another order; doubt one with another."""
    difference = differences(blocks, rest)
    differs, bands = median(np.abs(difference)), _bands(difference)
    if differs > ZOOM_DIFFERS:
        zooms, left = _zooms(difference, rest)
        if np.abs(zooms).max() > ZOOMED and left < min(ZOOM_LEAVES[0] * differs, ZOOM_LEAVES[1]):
            width, height = np.exp(zooms)
            text = f": by its light it shows {width:.2f} of the width and {height:.2f} of the height of its reference"
            return [doubt("pattern", name, text, remedy="take both with the same zoom and mode of the camera")]
    if differs > PATTERN_DIFFERS:
        exchange, left = nearest_exchange(blocks, rest, blocks.shape[0] == blocks.shape[1])
        if exchange and left < EXCHANGE_LEAVES * min(differs, PATTERN_DIFFERS):
            raise UnusablePicture(name, f": {exchange}, by its reference", remedy=CORRECT_IT)
    if bands.max() > BAND_DIFFERS and _is_torn(blocks, rest, difference, bands):
        raise UnusablePicture(name, ": it is torn, rows are shifted against its reference", remedy=COMPLETE)
    # Light that changes across the picture is another doubt.
    if differs > PATTERN_DOUBTFUL and median(np.abs(difference - smooth(difference, 2, rounds=6))) > PATTERN_DIFFERS:
        text = f": it differs by {100 * differs:.0f} % from its reference in more than half of its area"
        return [doubt("pattern", name, text, remedy=OTHER_SENSOR)]
    if (row := _cast_from(difference)) is not None:
        text = f": its lowest {100 * (1 - row / len(blocks)):.0f} % have other colours along the whole width"
        return [doubt("pattern", name, text, remedy=COMPLETE)]
    return []


def _zooms(difference: np.ndarray, rest: np.ndarray) -> tuple[np.ndarray, float]:
    """Return logarithms of the shares of its reference's width and height that a picture shows, and what is left.

    Least squares of the difference (rows, columns, 3) by the change that a zoom and a shift of the reference's light
    make; contacts, which are far from it, lose their weight.
    """
    rows, columns, colours = rest.shape
    y, x = np.meshgrid(*((np.arange(n) + 0.5) / n - 0.5 for n in (rows, columns)), indexing="ij")
    down, across = np.gradient(np.log(rest), 1 / rows, 1 / columns, axis=(0, 1))
    changes = (x[..., None] * across, y[..., None] * down, across, down, *np.eye(colours))
    terms = np.stack([np.broadcast_to(change, rest.shape) for change in changes], axis=-1).reshape(-1, len(changes))
    weights = np.ones(len(terms))
    for _ in range(ZOOM_ROUNDS):
        weighted = terms.T * weights
        change = np.linalg.solve(weighted @ terms + RIDGE * np.eye(len(changes)), weighted @ difference.ravel())
        left = difference - (terms @ change).reshape(rest.shape)
        weights = np.repeat(1 / (ZOOM_SCALE**2 + largest(np.abs(left)).ravel() ** 2), colours)
    return change[:2], median(np.abs(left - medians(left)))


def _bands(difference: np.ndarray) -> np.ndarray:
    """Return the median difference of each band of rows, (bands,)."""
    height = max(len(difference) // BANDS, 1)
    bands = len(difference) // height
    means = np.abs(difference[: bands * height].reshape(bands, height, -1).sum(axis=1) / height)
    middle = means.shape[1] // 2
    return np.partition(means, middle)[:, middle]


def _steps(difference: np.ndarray) -> np.ndarray:
    """Return the step from each row of blocks to the second next that three quarters of the columns exceed."""
    steps = largest(np.abs(difference[2:] - difference[:-2]))
    return np.sort(steps, axis=1)[:, steps.shape[1] // 4]


def _cast_from(difference: np.ndarray) -> int | None:
    """Return the row of blocks from which on all have another colour; None if they come back to the reference's."""
    places = np.flatnonzero(_steps(difference) > CAST)
    if not len(places) or median(np.abs(difference[places[-1] + 2 :])) < BAND_DIFFERS:
        return None
    return int(places[-1]) + 1


def _is_torn(blocks: np.ndarray, rest: np.ndarray, difference: np.ndarray, bands: np.ndarray) -> bool:
    """Return True if below a seam bands of rows agree with the reference once they are shifted, or rows are rolled."""
    if _steps(difference).max() < SEAM:
        return False
    left = [_bands(differences(np.roll(blocks, shift, axis=1), rest)) for shift in range(blocks.shape[1])]
    if np.any((bands > BAND_DIFFERS) & (np.min(left, axis=0) < EXCHANGE_LEAVES * bands)):
        return True
    rolled = min(pattern(np.roll(blocks, shift, axis=0), rest) for shift in range(blocks.shape[0]))
    return rolled < EXCHANGE_LEAVES * median(np.abs(difference))
