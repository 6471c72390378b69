# SPDX-License-Identifier: Apache-2.0
"""Finds the contact's circle in the picture of a ball press. Needs scikit-image: the extra `fit` of the package."""

from __future__ import annotations

import importlib.util
import math
from typing import NamedTuple

import numpy as np
from scipy.ndimage import map_coordinates

from tactile_depth.base.errors import InputError
from tactile_depth.calibrate.ball_press import Circle
from tactile_depth.chip.resampling import resampling

MOST_COLUMNS = 320  # of a picture that is searched
SMALLEST_CIRCLE_PX = 8
FAINTEST_CIRCLE = 0.1  # smallest deviation from the background along the circle
SHORTEST_ARC = 0.3  # fraction of the circle that must be visible
RAYS = 180


def require_circle_finder() -> None:
    """Raise InputError where scikit-image is missing."""
    if importlib.util.find_spec("skimage") is None:
        raise InputError(
            "a press has no circle, and scikit-image, which finds circles in pictures, is not installed: give the "
            "circles, or run pip install '.[fit]' in the repository"
        )


class Found(NamedTuple):
    """Contact found in a picture, and its width over its height as seen, which is 1 for a circle."""

    circle: Circle
    stretch: float


def find_circle(image: np.ndarray, background: np.ndarray, largest_radius: float, aspect: float = 1.0) -> Found | None:
    """Return the contact's circle in pixels of a picture; None if there is no visible circle.

    Larger pictures are averaged to 320 columns first, because lengths and filters below are meant for such pictures.

    First, a Hough transform of the edges of the colour's deviation locates the circle roughly. Its radius is too large,
    because the gel around the contact is drawn in. Then the crest of the deviation, where the ball is steepest, gives
    one point along each ray from the centre. A circle is fitted to these points without outliers (RANSAC). The result
    lies about a pixel inside the contact's edge, where the gel still touches the ball.

    Parameters
    ----------
    image, background : uint8 array (rows, columns, 3)
    largest_radius : float
        In pixels, down the rows, as the radius that is returned.
    aspect : float
        Width of a pixel over its height.
    """
    rows, columns = image.shape[:2]
    if columns <= MOST_COLUMNS:
        return _find(image.astype(np.float64), background.astype(np.float64), largest_radius, aspect)
    plan = resampling((rows, columns), (rows * MOST_COLUMNS // columns, MOST_COLUMNS))
    found = _find(plan.average(image), plan.average(background), largest_radius / plan.scale, aspect)
    if found is None:
        return None
    (x, y, radius), (top, left) = found.circle, plan.origin
    x, y = (x + 0.5) * plan.scale - 0.5 + left, (y + 0.5) * plan.scale - 0.5 + top
    return Found(Circle(x, y, radius * plan.scale), found.stretch)


def _find(image: np.ndarray, background: np.ndarray, largest_radius: float, aspect: float) -> Found | None:
    from skimage.filters import gaussian
    from skimage.measure import CircleModel, ransac
    from skimage.transform import resize

    reference = np.maximum(background, 1)
    magnitude = np.linalg.norm(gaussian((image - reference) / reference, 1.5, channel_axis=-1), axis=-1)
    if aspect != 1:  # square pixels, from edge to edge
        shape = (magnitude.shape[0], round(magnitude.shape[1] * aspect))
        aspect = shape[1] / magnitude.shape[1]
        magnitude = resize(magnitude, shape)
    centre_x, centre_y, rough = _rough_circle(magnitude, largest_radius)
    angle = np.linspace(0, 2 * np.pi, RAYS, endpoint=False)[:, None]
    along = np.arange(0.5 * rough, 1.05 * rough, 0.25)
    x, y = centre_x + np.cos(angle) * along, centre_y + np.sin(angle) * along
    profiles = map_coordinates(magnitude, [y, x], order=1, cval=np.nan)
    inside = np.isfinite(profiles).all(axis=1)
    if not inside.any():
        return None
    x, y, profiles = x[inside], y[inside], profiles[inside]
    crest = profiles.argmax(axis=1)
    clear = (crest > 0) & (crest < len(along) - 1) & (profiles.max(axis=1) > FAINTEST_CIRCLE)
    if clear.sum() < SHORTEST_ARC * RAYS:
        return None
    points = np.stack([grid[np.arange(len(crest)), crest][clear] for grid in (x, y)], axis=-1)
    model, on_circle = ransac(points, CircleModel, min_samples=8, residual_threshold=2, max_trials=200, rng=1)
    if model is None or on_circle.sum() < SHORTEST_ARC * RAYS:
        return None
    # `params` became `center` and `radius` in scikit-image 0.26.
    x, y, radius = (*model.center, model.radius) if hasattr(model, "center") else model.params
    stretch = _stretch(points[on_circle] - (x, y))
    return Found(Circle(float((x + 0.5) / aspect - 0.5), float(y), float(radius)), stretch)


def _stretch(offsets: np.ndarray) -> float:
    """Return width over height of the ellipse through points around its centre, (n, 2), x first."""
    angle, distance = np.arctan2(offsets[:, 1], offsets[:, 0]), np.hypot(*offsets.T)
    waves = [np.ones_like(angle), *(wave(k * angle) for k in (1, 2) for wave in (np.cos, np.sin))]
    mean, _, _, wider, _ = np.linalg.lstsq(np.stack(waves, axis=-1), distance, rcond=None)[0]
    return float((mean + wider) / (mean - wider))


def _rough_circle(magnitude: np.ndarray, largest_radius: float) -> tuple[float, float, float]:
    """Return centre column, centre row and radius of the circle that most edges of a map (rows, columns) lie on."""
    from skimage.feature import canny
    from skimage.transform import hough_circle

    radii = np.arange(SMALLEST_CIRCLE_PX, max(math.ceil(largest_radius), SMALLEST_CIRCLE_PX + 2))
    # Votes are divided by the root of the radius. Plain votes favour large circles; votes per length favour small ones.
    votes = hough_circle(canny(magnitude, sigma=1.5), radii, normalize=False, full_output=True)
    best = (votes.max(axis=(1, 2)) / np.sqrt(radii)).argmax()
    row, column = np.unravel_index(votes[best].argmax(), votes[best].shape)
    return float(column - radii[-1]), float(row - radii[-1]), float(radii[best])
