# SPDX-License-Identifier: Apache-2.0
"""Scale at which the light of a reference fits that of the calibration's own picture: the part of the gel it shows."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tactile_depth.base.errors import Argument, Part
from tactile_depth.chip.resampling import Share
from tactile_depth.pictures.blocks import RIDGE
from tactile_depth.pictures.doubts import VIEW, Doubt, doubt
from tactile_depth.sensor.sensor import UNTOUCHED_AREAS, Sensor, equal_areas, overlaps
from tactile_depth.sensor.view import CONVENTIONS, VIEWS_AGREE

# RMS of log(reference / calibration's picture) after scale, shift, and a plane for each colour. The same specimen in
# another view, in light times 0.8 to 1.1 that changes by 1 % to each side, with noise, as JPEG of quality 85: 0.0064 at
# most, and at most 0.31 of what the best shift alone leaves. 88 drawn specimens in the same view: 0.0098 and more, and
# 0.8 and more of it, or 0.046 and more; the same specimen in light with a vignette of 5 %: 0.68 of it and more.
FITS, OF_SHIFTED = 0.015, 0.5
AS_IS = 0.004  # what is left at scale 1 from which another view can fit; views of 0.95: 0.0073 and more
SAME_VIEW = 0.035  # difference of two views that changes heights by less than 5 %; views of 0.95 are right by 0.002
SCALES, FARTHEST = (0.4, 2.5), 0.15  # largest scale either way, and largest shift, of the picture
STARTS, STEPS, SMALLEST_STEP = (1.0, 0.63, 1.6), 8, 1e-3
FINE = (4 * UNTOUCHED_AREAS[0], 4 * UNTOUCHED_AREAS[1])  # areas of a reference, from which those of a scale are made


class Placed(NamedTuple):
    """A picture's place on the calibration's picture.

    Attributes
    ----------
    scale : float
        Share of the calibration's width and height that the picture shows.
    shift : float64 array (2,)
        From middle to middle, along the columns and down the rows, of the calibration's width and height.
    left : float
        RMS difference that is left.
    """

    scale: float
    shift: np.ndarray
    left: float


def share_shown(reference: np.ndarray, untouched: np.ndarray) -> float:
    """Return the share of the width and height of the calibration's picture that a reference shows.

    Parameters
    ----------
    reference : array (rows, columns, 3)
    untouched : array (`UNTOUCHED_AREAS`, 3)

    Returns
    -------
    float
        1 also if its light fits at no scale, as that of another specimen.
    """
    fit = _Fit(equal_areas(reference, FINE), untouched)
    if fit.difference(1, np.zeros(2))[1] < AS_IS:
        return 1.0
    shifted = fit.place(1, free=slice(1, 3)).left
    best = Placed(1, np.zeros(2), np.inf)
    for start in STARTS:
        best = min(best, fit.place(start, free=slice(0, 3)), key=lambda placed: placed.left)
        if best.left < AS_IS:
            break
    fits = best.left < min(FITS, OF_SHIFTED * shifted)
    return best.scale if fits and abs(np.log(best.scale)) > SAME_VIEW else 1.0


def other_view(sensor: Sensor, reference: np.ndarray, name: Part, share: Share) -> list[Doubt]:
    """Doubt a reference that shows more or less of the gel than the calibration's pictures.

    Parameters
    ----------
    reference : array (rows, columns, 3)
        A share of what the user gave.
    """
    if sensor.untouched is None or (scale := share_shown(reference, sensor.untouched)) == 1:
        return []
    size = "large" if scale < 1 else "small"
    text = f": by its light it shows {scale:.2f} of the width and height that it should, so heights are too {size}"
    remedy: tuple[Part, ...] = ("give pictures that show as much of the gel as those of the calibration",)
    if sensor.view is not None:
        width, height = (scale * view / float(part) for view, part in zip(sensor.view, share[::-1], strict=True))
        remedy = ("give ", Argument("crop", _named(width, height)), ", what the pictures show")
    return [doubt(VIEW, name, text, remedy=remedy)]


def _named(width: float, height: float) -> str | float:
    """Return a view as `crop` takes it: a convention that is near, or shares."""
    name, share = min(CONVENTIONS.items(), key=lambda each: abs(each[1] - width) + abs(each[1] - height))
    if max(abs(width / share - 1), abs(height / share - 1)) < VIEWS_AGREE or min(width, height) > 1:
        return name
    shares = round(min(width, 1), 2), round(min(height, 1), 2)
    return shares[0] if shares[0] == shares[1] else "{:g},{:g}".format(*shares)


class _Fit:
    """Least squares of log(reference / calibration's picture) in the areas of the latter.

    Free are the scale, the shift, and a plane for each colour.
    """

    def __init__(self, levels: np.ndarray, untouched: np.ndarray) -> None:
        self._levels = levels
        self._own = np.log(np.maximum(untouched, 1))
        down, across = np.gradient(self._own, *(1 / count for count in UNTOUCHED_AREAS), axis=(0, 1))
        self._y, self._x = np.meshgrid(*((np.arange(n) + 0.5) / n - 0.5 for n in UNTOUCHED_AREAS), indexing="ij")
        outward = self._x[..., None] * across + self._y[..., None] * down
        self._slopes = np.stack((outward, across, down), axis=-1)

    def difference(self, scale: float, shift: np.ndarray) -> tuple[np.ndarray, float, np.ndarray]:
        """Return what is left, (areas, 3), its RMS, and its change by scale and shift, (areas, 3, 3)."""
        (across, columns), (down, rows) = (
            _cells(count, scale, by) for count, by in zip(UNTOUCHED_AREAS[::-1], shift, strict=True)
        )
        seen = np.moveaxis(down @ np.moveaxis(across @ self._levels, 2, 0), 0, 2)
        both = np.ix_(rows, columns)
        x, y = self._x[both].ravel(), self._y[both].ravel()
        own, slopes = self._own[both].reshape(-1, 3), self._slopes[both].reshape(-1, 9)
        values = np.concatenate((np.log(np.maximum(seen.reshape(-1, 3), 1)) - own, slopes), axis=1)
        plane = np.linalg.qr(np.stack((np.ones_like(x), x, y), axis=1))[0]
        values -= plane @ (plane.T @ values)
        left = values[:, :3]
        return left, float(np.sqrt((left**2).mean())), values[:, 3:].reshape(-1, 3, 3)

    def place(self, scale: float, free: slice) -> Placed:
        """Return the best place from a first scale; `free`: of scale, shift along columns, and down rows."""
        shift = np.zeros(2)
        left, rms, changes = self.difference(scale, shift)
        best = Placed(scale, shift, rms)
        for _ in range(STEPS):
            step = np.zeros(3)
            terms = changes.reshape(-1, 3)[:, free]
            step[free] = np.linalg.solve(terms.T @ terms + RIDGE * np.eye(terms.shape[1]), terms.T @ left.ravel())
            if np.abs(step).max() < SMALLEST_STEP:
                break
            scale = float(np.clip(scale * np.exp(np.clip(step[0], -0.1, 0.1)), *SCALES))
            shift = np.clip(shift + step[1:], -FARTHEST, FARTHEST)
            left, rms, changes = self.difference(scale, shift)
            best = min(best, Placed(scale, shift, rms), key=lambda placed: placed.left)
        return best


def _cells(count: int, scale: float, shift: float) -> tuple[np.ndarray, np.ndarray]:
    """Return weights (cells, areas of `FINE`) of those of `count` equal parts that a picture shows, and their indices.

    The picture shows `scale` of the parts, with its middle `shift` from theirs.
    """
    edges = (np.linspace(-0.5, 0.5, count + 1) - shift) / scale + 0.5
    shows = np.flatnonzero((edges[:-1] > -1e-6) & (edges[1:] < 1 + 1e-6))
    length = 4 * count
    return overlaps(length, edges[shows[0] : shows[-1] + 2] * length), shows
