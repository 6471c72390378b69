# SPDX-License-Identifier: Apache-2.0
"""Scales at which the light of a reference fits that of the calibration's own picture: the part of the gel it shows."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

import numpy as np

from tactile_depth.base.errors import Argument, Part
from tactile_depth.chip.resampling import Share
from tactile_depth.pictures.blocks import RIDGE
from tactile_depth.pictures.doubts import VIEW, Doubt, doubt
from tactile_depth.sensor.sensor import UNTOUCHED_AREAS, Sensor, equal_areas, overlaps
from tactile_depth.sensor.view import CONVENTIONS, VIEWS_AGREE, view_of

# RMS of log(reference / calibration's picture) after two scales, shift, and a plane for each colour, and its share of
# what the best shift alone leaves. The same Mini or DIGIT in another view, also of one axis alone, in light times 0.8
# to 1.1 that changes by 1 % to each side, with noise, as JPEG of quality 85: 0.007 and 0.42 at most. 180 drawn
# specimens in the same view: 0.72 and more of it; in light with a vignette of 5 %, also of one axis: 0.51 and more.
FITS, OF_SHIFTED = 0.015, 0.45
AS_IS = 0.004  # what is left at scale 1 from which another view can fit; views of 0.95: 0.0073 and more
SAME_VIEW = 0.035  # difference of two views that changes heights by less than 5 %; views of 0.95 are right by 0.002
SAME_ASPECT = 0.025  # difference of the scales of both axes: one scale 0.007 at most, one axis of 0.95: 0.047 and more
SCALES, FARTHEST = (0.4, 2.5), 0.15  # largest scale either way, and largest shift, of the picture
STARTS, STEPS, SMALLEST_STEP = (1.0, 0.63, 1.6), 8, 1e-3
FINE = (4 * UNTOUCHED_AREAS[0], 4 * UNTOUCHED_AREAS[1])  # areas of a reference, from which those of a scale are made


class Placed(NamedTuple):
    """A picture's place on the calibration's picture.

    Attributes
    ----------
    scales : float64 array (2,)
        Shares of the calibration's width and height that the picture shows.
    shift : float64 array (2,)
        From middle to middle, along the columns and down the rows, of the calibration's width and height.
    left : float
        RMS difference that is left.
    """

    scales: np.ndarray
    shift: np.ndarray
    left: float


def shares_shown(reference: np.ndarray, untouched: np.ndarray) -> tuple[float, float]:
    """Return the shares of the width and of the height of the calibration's picture that a reference shows.

    Parameters
    ----------
    reference : array (rows, columns, 3)
    untouched : array (`UNTOUCHED_AREAS`, 3)

    Returns
    -------
    (float, float)
        1 each also if its light fits at no scale, as that of another specimen.
    """
    fit, as_is = _Fit(equal_areas(reference, FINE), untouched), Placed(np.ones(2), np.zeros(2), np.inf)
    if fit.difference(as_is.scales, as_is.shift)[1] < AS_IS:
        return 1.0, 1.0
    shifted = fit.place(1, free=slice(2, 4)).left
    best = as_is
    for start in STARTS:
        best = min(best, fit.place(start, free=slice(0, 4)), key=lambda placed: placed.left)
        if best.left < AS_IS:
            break
    sizes = np.log(best.scales)
    if best.left >= min(FITS, OF_SHIFTED * shifted) or np.abs(sizes).max() < SAME_VIEW:
        return 1.0, 1.0
    if abs(sizes[0] - sizes[1]) < SAME_ASPECT:
        sizes[:] = sizes.mean()
    width, height = map(float, np.exp(sizes))
    return width, height


def other_view(sensor: Sensor, reference: np.ndarray, name: Part, share: Share) -> list[Doubt]:
    """Doubt a reference that shows more or less of the gel than the calibration's pictures.

    Parameters
    ----------
    reference : array (rows, columns, 3)
        A share of what the user gave.
    """
    if sensor.untouched is None or (shares := shares_shown(reference, sensor.untouched)) == (1, 1):
        return []
    width, height = shares
    is_squeezed = width != height
    part = f"{width:.2f} of the width and {f'{height:.2f} of the ' * is_squeezed}height that it should"
    size = "wrong" if is_squeezed else f"too {'large' if width < 1 else 'small'}"
    remedy: tuple[Part, ...] = ("give pictures that show as much of the gel as those of the calibration",)
    if sensor.view is not None:
        crop = _named(width * sensor.view[0] / float(share[1]), height * sensor.view[1] / float(share[0]))
        resize = f"resize the pictures to {_unsqueezed(sensor, len(reference) / share[0], crop)} and " * is_squeezed
        remedy = (f"{resize}give ", Argument("crop", crop), ", what the pictures show")
    return [doubt(VIEW, name, f": by its light it shows {part}, so heights are {size}", remedy=remedy)]


def _unsqueezed(sensor: Sensor, rows: Fraction, crop: str | float) -> str:
    """Return the size of pictures of so many rows that show a crop with pixels as wide as those of the calibration."""
    assert sensor.camera is not None
    assert sensor.view is not None
    width, height = (shown / own for shown, own in zip(view_of(crop), sensor.view, strict=True))
    columns = float(rows) * sensor.camera.columns * width / (sensor.camera.rows * height)
    return f"{round(columns)} x {round(rows)}"


def _named(width: float, height: float) -> str | float:
    """Return a view as `crop` takes it: a convention that is near, or shares."""
    name, share = min(CONVENTIONS.items(), key=lambda each: abs(each[1] - width) + abs(each[1] - height))
    if max(abs(width / share - 1), abs(height / share - 1)) < VIEWS_AGREE or min(width, height) > 1:
        return name
    shares = round(min(width, 1), 2), round(min(height, 1), 2)
    return shares[0] if shares[0] == shares[1] else "{:g},{:g}".format(*shares)


class _Fit:
    """Least squares of log(reference / calibration's picture) in the areas of the latter.

    Free are the scales of both axes, the shift, and a plane for each colour.
    """

    def __init__(self, levels: np.ndarray, untouched: np.ndarray) -> None:
        self._levels = levels
        self._own = np.log(np.maximum(untouched, 1))
        down, across = np.gradient(self._own, *(1 / count for count in UNTOUCHED_AREAS), axis=(0, 1))
        self._y, self._x = np.meshgrid(*((np.arange(n) + 0.5) / n - 0.5 for n in UNTOUCHED_AREAS), indexing="ij")
        slopes = self._x[..., None] * across, self._y[..., None] * down, across, down
        self._slopes = np.stack(slopes, axis=-1)

    def difference(self, scales: np.ndarray, shift: np.ndarray) -> tuple[np.ndarray, float, np.ndarray]:
        """Return what is left, (areas, 3), its RMS, and its change by scales and shift, (areas, 3, 4)."""
        (across, columns), (down, rows) = (
            _cells(count, scale, by) for count, scale, by in zip(UNTOUCHED_AREAS[::-1], scales, shift, strict=True)
        )
        seen = np.moveaxis(down @ np.moveaxis(across @ self._levels, 2, 0), 0, 2)
        both = np.ix_(rows, columns)
        x, y = self._x[both].ravel(), self._y[both].ravel()
        own, slopes = self._own[both].reshape(-1, 3), self._slopes[both].reshape(-1, 12)
        values = np.concatenate((np.log(np.maximum(seen.reshape(-1, 3), 1)) - own, slopes), axis=1)
        plane = np.linalg.qr(np.stack((np.ones_like(x), x, y), axis=1))[0]
        values -= plane @ (plane.T @ values)
        left = values[:, :3]
        return left, float(np.sqrt((left**2).mean())), values[:, 3:].reshape(-1, 3, 4)

    def place(self, scale: float, free: slice) -> Placed:
        """Return the best place from a first scale; `free`: of both scales, shift along columns, and down rows."""
        scales, shift = np.full(2, scale), np.zeros(2)
        left, rms, changes = self.difference(scales, shift)
        best = Placed(scales, shift, rms)
        for _ in range(STEPS):
            step = np.zeros(4)
            terms = changes.reshape(-1, 4)[:, free]
            step[free] = np.linalg.solve(terms.T @ terms + RIDGE * np.eye(terms.shape[1]), terms.T @ left.ravel())
            if np.abs(step).max() < SMALLEST_STEP:
                break
            scales = np.clip(scales * np.exp(np.clip(step[:2], -0.1, 0.1)), *SCALES)
            shift = np.clip(shift + step[2:], -FARTHEST, FARTHEST)
            left, rms, changes = self.difference(scales, shift)
            best = min(best, Placed(scales, shift, rms), key=lambda placed: placed.left)
        return best


def _cells(count: int, scale: float, shift: float) -> tuple[np.ndarray, np.ndarray]:
    """Return weights (cells, areas of `FINE`) of those of `count` equal parts that a picture shows, and their indices.

    The picture shows `scale` of the parts, with its middle `shift` from theirs.
    """
    edges = (np.linspace(-0.5, 0.5, count + 1) - shift) / scale + 0.5
    shows = np.flatnonzero((edges[:-1] > -1e-6) & (edges[1:] < 1 + 1e-6))
    length = 4 * count
    return overlaps(length, edges[shows[0] : shows[-1] + 2] * length), shows
