# SPDX-License-Identifier: Apache-2.0
"""Finds the contact's circle in the picture of a ball press. Needs scikit-image: the extra `fit` of the package.

A ball tilts the gel in every direction around its centre, so colours change linearly with the position in the contact.
`_soft_circle` finds where, and in what size, a linear change explains most. That holds for any gel, but its radius is
only good to 10 %. If the contact has an edge, as in a thin gel, `_edge_circle` measures it to a pixel.
"""

from __future__ import annotations

import importlib.util
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.ndimage import gaussian_filter, gaussian_filter1d, map_coordinates

from tactile_depth.base.errors import InputError, install
from tactile_depth.calibrate.ball_press import Circle
from tactile_depth.chip.resampling import resampling

MOST_COLUMNS = 320  # of a picture that is searched
SMALLEST_CIRCLE_PX = 8
STEP = 3  # pixels between the positions at which the change of colour is fitted
SCALES = 16  # sizes of the window in which it is fitted, from the smallest circle to the largest
RADIUS = 1.55  # of a soft contact, in standard deviations of its window. 14 presses of a DIGIT: 1.45 to 1.70
# Change of colour over the mean light. Fewest of 45 presses of a Mini: 0.07; most with noise of 8 grey levels: 0.022.
FAINTEST = 0.03
# Fraction of the squared change of colour in the window that is linear. Least of 45 presses of a Mini: 0.48, of a
# DIGIT: 0.47, of drawn balls up to 0.95 of their radius: 0.41; most of untouched gel that changed as much: 0.37.
LEAST_LINEAR = 0.39
# Second difference of the deviation across the edge, from 0.7 to 1.3 of the radius, over the deviation there. Least of
# 45 presses of a Mini: 0.43; most of 14 presses of a DIGIT, also mirrored, with noise and as JPEG: 0.37.
SHARPEST_SOFT, EDGE_WIDTH, LEAST_WIDTH_PX = 0.4, 0.3, 4
# Edge over soft radius, and distance of their centres over the soft radius. 45 presses of a Mini: 0.72 to 0.95, 0.27.
EDGE_RADII, EDGE_CENTRE = (0.45, 1.6), 0.5
# Width over height of found contacts, less 1. Real presses: 0.04, by the light; pixels 8 % narrower than high: 0.08.
STRETCHED, FEWEST_STRETCHES = 0.06, 4
SHORTEST_ARC = 0.3  # fraction of the circle that must be visible
RAYS = 180


def require_circle_finder() -> None:
    """Raise InputError where scikit-image is missing."""
    if importlib.util.find_spec("skimage") is None:
        raise InputError(
            "a press has no circle, and scikit-image, which finds circles in pictures, is not installed: give the "
            f"circles, or {install('fit')}"
        )


class Found(NamedTuple):
    """Contact found in a picture, and its width over its height as seen: 1 for a circle, None without a sharp edge."""

    circle: Circle
    stretch: float | None


def find_circle(image: np.ndarray, background: np.ndarray, ball_radius: float, aspect: float = 1.0) -> Found | None:
    """Return the contact's circle in pixels of a picture; None if there is no visible circle.

    Larger pictures are averaged to 320 columns first, because lengths and filters below are meant for such pictures.

    Parameters
    ----------
    image, background : uint8 array (rows, columns, 3)
    ball_radius : float
        In pixels, down the rows. Circles up to twice as large are found, to tell of a wrong ball.
    aspect : float
        Width of a pixel over its height.
    """
    rows, columns = image.shape[:2]
    if columns <= MOST_COLUMNS:
        return _find(image.astype(np.float64), background.astype(np.float64), ball_radius, aspect)
    plan = resampling((rows, columns), (rows * MOST_COLUMNS // columns, MOST_COLUMNS))
    found = _find(plan.average(image), plan.average(background), ball_radius / plan.scale, aspect)
    if found is None:
        return None
    (x, y, radius), (top, left) = found.circle, plan.origin
    x, y = (x + 0.5) * plan.scale - 0.5 + left, (y + 0.5) * plan.scale - 0.5 + top
    return Found(Circle(x, y, radius * plan.scale), found.stretch)


def _find(image: np.ndarray, background: np.ndarray, ball_radius: float, aspect: float) -> Found | None:
    from skimage.transform import resize

    if aspect != 1:  # square pixels, from edge to edge
        rows, columns = image.shape[:2]
        shape = (rows, round(columns * aspect), 3)
        aspect = shape[1] / columns
        image, background = resize(image, shape), resize(background, shape)
    soft = _soft_circle(image, background, min(2.0 * ball_radius, *image.shape[:2]))
    found = None if soft is None else _edge_circle(image, background, soft)
    if found is None and soft is not None:
        centre_is_seen = 0 < soft.x < image.shape[1] - STEP and 0 < soft.y < image.shape[0] - STEP
        found = Found(soft, None) if centre_is_seen else None
    if found is None:
        return None
    x, y, radius = found.circle
    return Found(Circle((x + 0.5) / aspect - 0.5, y, radius), found.stretch)


def _soft_circle(image: np.ndarray, background: np.ndarray, largest_radius: float) -> Circle | None:
    """Return the circle in which a linear change of colour explains most; None if that is faint or no such change.

    The mean of the three colours is taken out first, because shadows, and lights that drift, change all of them.
    """
    change = (image - background) / max(background.mean(), 1)
    colours = gaussian_filter(change - change.mean(axis=-1, keepdims=True), (STEP / 2, STEP / 2, 0))[::STEP, ::STEP]
    largest = max(largest_radius, 2 * SMALLEST_CIRCLE_PX)
    windows = np.geomspace(SMALLEST_CIRCLE_PX, largest, SCALES) / RADIUS / STEP
    linear = np.stack([_linear_change(colours, window) for window in windows])
    size, row, column = np.unravel_index(linear.argmax(), linear.shape)
    window, most = float(windows[size]), linear[size, row, column]
    amount, inside = (
        window**2 * gaussian_filter(part, window, mode="constant")[row, column]
        for part in ((colours**2).sum(axis=-1), np.ones(colours.shape[:2]))
    )
    if size == SCALES - 1 or most < max(FAINTEST**2 * inside, LEAST_LINEAR * amount):
        return None
    if size > 0:  # vertex of the parabola through the three best sizes
        before, best, after = np.log(linear[size - 1 : size + 2].max(axis=(1, 2)))
        window *= (windows[1] / windows[0]) ** ((before - after) / 2 / (before - 2 * best + after))
    return Circle(float(column * STEP), float(row * STEP), float(RADIUS * STEP * window))


def _linear_change(colours: np.ndarray, window: float) -> np.ndarray:
    """Return how much a linear change around each position explains of colours (rows, columns, 3), (rows, columns).

    It is the sum of squares of the least-squares fit of colours = A offset, with Gaussian weights of standard deviation
    `window`. Derivatives of a Gaussian are moments: the first is the offset's, so that one filter fits all positions.
    """

    def moments(count: int) -> list[np.ndarray]:
        """Return sums of weights times offset to the power of 0, 1, 2 along an axis that ends at the picture's edge."""
        ones = np.ones(count)
        zeroth, first, second = (gaussian_filter1d(ones, window, order=k, mode="constant") for k in range(3))
        return [zeroth, window**2 * first, window**2 * (zeroth + window**2 * second)]

    x, y = (
        window**2 * gaussian_filter(colours, (window, window, 0), order=(*order, 0), mode="constant")
        for order in ((0, 1), (1, 0))
    )
    (y0, y1, y2), (x0, x1, x2) = (moments(count) for count in colours.shape[:2])
    xx, yy, xy = np.outer(y0, x2), np.outer(y2, x0), np.outer(y1, x1)
    fitted = yy * (x * x).sum(axis=-1) - 2 * xy * (x * y).sum(axis=-1) + xx * (y * y).sum(axis=-1)
    return window**2 * fitted / (xx * yy - xy**2)


def _edge_circle(image: np.ndarray, background: np.ndarray, soft: Circle) -> Found | None:
    """Return the circle of the contact's edge; None if there is no sharp one near a soft circle.

    First, a Hough transform of the edges of the colour's deviation locates the circle roughly. Its radius is too large,
    because the gel around the contact is drawn in. Then the crest of the deviation, where the ball is steepest, gives
    one point along each ray from the centre. A circle is fitted to these points without outliers (RANSAC). The result
    lies about a pixel inside the contact's edge, where the gel still touches the ball.
    """
    from skimage.measure import CircleModel, ransac

    reference = np.maximum(background, 1)
    magnitude = np.linalg.norm(gaussian_filter((image - reference) / reference, (1.5, 1.5, 0)), axis=-1)
    rough = _rough_circle(magnitude, soft)
    angle = np.linspace(0, 2 * np.pi, RAYS, endpoint=False)[:, None]
    along = np.arange(0.5 * rough.radius, 1.05 * rough.radius, 0.25)
    x, y, profiles = _profiles(magnitude, rough, angle, along)
    crest = profiles.argmax(axis=1)
    clear = (crest > 0) & (crest < len(along) - 1)
    if clear.sum() < SHORTEST_ARC * RAYS:
        return None
    points = np.stack([grid[np.arange(len(crest)), crest][clear] for grid in (x, y)], axis=-1)
    model, on_circle = ransac(points, CircleModel, min_samples=8, residual_threshold=2, max_trials=200, rng=1)
    if model is None or on_circle.sum() < SHORTEST_ARC * RAYS:
        return None
    # `params` became `center` and `radius` in scikit-image 0.26.
    edge = Circle(*map(float, (*model.center, model.radius) if hasattr(model, "center") else model.params))
    width = max(EDGE_WIDTH * edge.radius, LEAST_WIDTH_PX)
    *_, across = _profiles(magnitude, edge, angle, edge.radius + np.array([-width, 0, width]))
    if not len(across):
        return None
    inside, at_edge, outside = across.mean(axis=0)
    is_sharp = 2 * at_edge - inside - outside > SHARPEST_SOFT * at_edge
    is_near = math.hypot(edge.x - soft.x, edge.y - soft.y) < EDGE_CENTRE * soft.radius
    if not is_sharp or not is_near or not EDGE_RADII[0] < edge.radius / soft.radius < EDGE_RADII[1]:
        return None
    return Found(edge, _stretch(points[on_circle] - (edge.x, edge.y)))


def _profiles(
    magnitude: np.ndarray, centre: Circle, angle: np.ndarray, along: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return columns, rows and values along the rays that lie in a map (rows, columns), (rays, points) each."""
    x, y = centre.x + np.cos(angle) * along, centre.y + np.sin(angle) * along
    values = map_coordinates(magnitude, [y, x], order=1, cval=np.nan)
    inside = np.isfinite(values).all(axis=1)
    return x[inside], y[inside], values[inside]


def _stretch(offsets: np.ndarray) -> float:
    """Return width over height of the ellipse through points around its centre, (n, 2), x first."""
    angle, distance = np.arctan2(offsets[:, 1], offsets[:, 0]), np.hypot(*offsets.T)
    waves = [np.ones_like(angle), *(wave(k * angle) for k in (1, 2) for wave in (np.cos, np.sin))]
    mean, _, _, wider, _ = np.linalg.lstsq(np.stack(waves, axis=-1), distance, rcond=None)[0]
    return float((mean + wider) / (mean - wider))


def _rough_circle(magnitude: np.ndarray, soft: Circle) -> Circle:
    """Return the circle near a soft one that most edges of a map (rows, columns) lie on."""
    from skimage.feature import canny
    from skimage.transform import hough_circle

    low, high = EDGE_RADII
    radii = np.arange(max(SMALLEST_CIRCLE_PX, math.floor(low * soft.radius)), math.ceil(high * soft.radius) + 1)
    reach = math.ceil(EDGE_CENTRE * soft.radius) + int(radii[-1])
    top, left = max(round(soft.y) - reach, 0), max(round(soft.x) - reach, 0)
    edges = canny(magnitude, sigma=1.5)[top : round(soft.y) + reach + 1, left : round(soft.x) + reach + 1]
    votes = hough_circle(edges, radii, normalize=False, full_output=True)
    rows, columns = (np.arange(count) - radii[-1] for count in votes.shape[1:])
    rows, columns = rows + top, columns + left
    votes[:, np.hypot(rows[:, None] - soft.y, columns - soft.x) > EDGE_CENTRE * soft.radius] = 0
    if not votes.any():  # a faint contact has no edges for a Hough transform
        return Circle(soft.x, soft.y, 1.15 * soft.radius)
    # Votes are divided by the root of the radius. Plain votes favour large circles; votes per length favour small ones.
    best = (votes.max(axis=(1, 2)) / np.sqrt(radii)).argmax()
    row, column = np.unravel_index(votes[best].argmax(), votes[best].shape)
    return Circle(float(columns[column]), float(rows[row]), float(radii[best]))


def stretched(stretches: Sequence[float]) -> list[str]:
    """Return a line if contacts of balls are ellipses."""
    if len(stretches) < FEWEST_STRETCHES or abs(stretch := float(np.median(stretches)) - 1) < STRETCHED:
        return []
    wider = "wider" if stretch > 0 else "narrower"
    return [
        f"contacts are {100 * abs(stretch):.0f} % {wider} than high, and those of balls are circles: if pixels are not "
        "square, give pitch_mm=(height, width) of a pixel"
    ]
