# SPDX-License-Identifier: Apache-2.0
"""Built-in contacts, and the synthetic tri-colour sensor that sees them.

The sensor: three lights 120 degrees apart, each colour linear in the slope towards its light,

    I_c = REST + GAIN (lx_c gx + ly_c gy) + normal noise,   rounded to 8 bits.

It leaves out what a real gel adds: shadows, light that falls off with distance, colours that mix, a lens.

A height map is drawn where the pipeline will find it: the slope of a pixel is the forward difference of the
height, so that divergence and solve return the very map that was drawn. All lengths scale with the grid.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from models.errors import InputError

SENSOR_WIDTH_MM = 15.232  # 128 pixels of 0.119 mm
REST = 135.5  # middle of a 4-bit bin: noise does not move the colour of a flat gel to another
GAIN = 112.0  # grey levels per unit of slope: a slope of 1 nearly fills 8 bits
NOISE = 1.0  # standard deviation, grey levels
SLOPE_LIMIT = 0.95  # of every scene
LIGHTS = np.array([(math.cos(t), math.sin(t)) for t in (math.pi / 2, math.pi * 7 / 6, math.pi * 11 / 6)])
"""Directions (lx, ly) of the red, green and blue light, 120 degrees apart, float64 (3, 2)."""


@dataclass(frozen=True)
class Scene:
    """A rendered scene.

    Attributes
    ----------
    frames : uint8 array (frames, rows, columns, 3), RGB
    height : float64 array (frames, rows, columns), true depth in grid pixels, positive pressed in
    name : str
    """

    frames: np.ndarray
    height: np.ndarray
    name: str


def scene_pixel_pitch_mm(size: int) -> float:
    """Pitch of the grid in mm: the synthetic sensor is as wide whatever the grid."""
    return SENSOR_WIDTH_MM / size


def render(name: str, rows: int, columns: int = 0, seed: int = 1) -> Scene:
    """Render a scene of the registry on a grid of `rows` by `columns` (0: square).

    The scene fills the largest square in the middle of the grid; around it the gel is untouched.

    Parameters
    ----------
    seed : int
        Of the camera's noise.

    Raises
    ------
    InputError
        No scene of that name.
    """
    if name not in SCENES:
        raise InputError(f"unknown scene {name}: accepted are {', '.join(SCENES)}")
    columns = columns or rows
    size = min(rows, columns)
    top, left = (rows - size) // 2, (columns - size) // 2
    margins = ((0, 0), (top, rows - size - top), (left, columns - size - left))
    height = np.pad(SCENES[name](size), margins)
    return Scene(photograph(height, seed), height, name)


def photograph(height: np.ndarray, seed: int = 1) -> np.ndarray:
    """What the synthetic sensor sees of height maps (..., N, N) in grid pixels: uint8 (..., N, N, 3)."""
    noise = np.random.default_rng(seed).normal(scale=NOISE, size=(*height.shape, 3))
    return np.clip(np.rint(REST + GAIN * slopes_of(height) @ LIGHTS.T + noise), 0, 255).astype(np.uint8)


def slopes_of(height: np.ndarray) -> np.ndarray:
    """Forward differences along columns and rows, zero outside the frame: (..., N, N) to (..., N, N, 2)."""
    return np.stack((np.diff(height, axis=-1, append=0), np.diff(height, axis=-2, append=0)), axis=-1)


# Drawing: a shape is the distance from a skeleton (a point, a circle, strokes) put through a profile.


def _axes(size: int) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates x along the columns, y down the rows, from the middle of the frame, in frame widths."""
    x = (np.arange(size) + 0.5) / size - 0.5
    return x[None, :], x[:, None]


def _point(size: int, x: float = 0, y: float = 0) -> np.ndarray:
    columns, rows = _axes(size)
    return np.hypot(columns - x, rows - y)


def _circle(size: int, radius: float, x: float = 0, y: float = 0) -> np.ndarray:
    return np.abs(_point(size, x, y) - radius)


def _strokes(size: int, corners: list[tuple[float, float]]) -> np.ndarray:
    """Distance from the line that joins the corners (x, y)."""
    columns, rows = _axes(size)
    distance = np.full((size, size), np.inf)
    for (x0, y0), (x1, y1) in pairwise(corners):
        dx, dy = x1 - x0, y1 - y0
        along = np.clip(((columns - x0) * dx + (rows - y0) * dy) / (dx * dx + dy * dy), 0, 1)
        distance = np.minimum(distance, np.hypot(columns - x0 - along * dx, rows - y0 - along * dy))
    return distance


def _star(radius: float, waist: float) -> list[tuple[float, float]]:
    """Outline of a five-pointed star, closed."""
    turns = np.arange(11) / 10
    reach = np.where(np.arange(11) % 2, waist, radius)
    return [(r * math.sin(2 * math.pi * t), -r * math.cos(2 * math.pi * t)) for r, t in zip(reach, turns, strict=True)]


def _cap(distance: np.ndarray, peak: float, edge_slope: float) -> np.ndarray:
    """A round body pressed in: circular where it touches, then the gel rising smoothly to its rest.

    `edge_slope` is the slope where contact ends; it and the peak give the radius of the body. The gel leaves
    the body with that slope and flattens, as a parabola, over 0.3 radii.
    """
    touching = edge_slope / math.hypot(1, edge_slope)  # lengths in radii, up to the last line
    skirt = 0.3
    sagitta = 1 - math.sqrt(1 - touching**2)
    rim = edge_slope * skirt / 2
    radius = peak / (sagitta + rim)
    r = distance / radius
    body = np.sqrt(1 - np.minimum(r, touching) ** 2) - (1 - sagitta) + rim
    gel = rim * np.clip(1 - (r - touching) / skirt, 0, 1) ** 2
    return radius * np.where(r < touching, body, gel)


def _ridge(distance: np.ndarray, peak: float, half_width: float) -> np.ndarray:
    """A raised cosine over the distance: steepest pi/2 peak / half_width."""
    return peak / 2 * (1 + np.cos(np.pi * np.minimum(distance / half_width, 1)))


# Heights (N, N) in grid pixels.


def dome(size: int, peak_px: float) -> np.ndarray:
    """One smooth dome (raised cosine) in the middle of the frame; a deep one is as narrow as slopes allow.

    Parameters
    ----------
    size : int
        Rows and columns.
    peak_px : float
        Depth of its deepest point, in grid pixels.

    Returns
    -------
    float64 array (size, size), in grid pixels

    Raises
    ------
    InputError
        Not above 0, or too deep for the slope limit on this grid.
    """
    widest = size / 2 - 1
    deepest = widest * SLOPE_LIMIT * 2 / math.pi
    if not 0 < peak_px <= deepest:
        raise InputError(f"a dome of {peak_px:g} pixels on a grid of {size}: accepted is up to {deepest:.4g}")
    half_width = max(math.pi / 2 * peak_px / SLOPE_LIMIT, size / 4)
    tip = 0.5 / size  # on a sample
    return _ridge(size * _point(size, tip, tip), peak_px, half_width)


def _seal(size: int) -> np.ndarray:
    border = _ridge(_circle(size, 0.34), 0.026, 0.055)
    star = _ridge(_strokes(size, _star(0.25, 0.115)), 0.022, 0.048)
    return size * np.maximum(border, star)


def _ball(size: int) -> np.ndarray:
    return size * _cap(_point(size, 0.03, -0.02), 0.09, 0.85)


def _ring(size: int) -> np.ndarray:
    return size * _cap(_circle(size, 0.26, -0.02, 0.02), 0.05, 0.8)


# Scenes: heights (frames, N, N) in grid pixels.


def flat(size: int) -> np.ndarray:
    """No contact. Leaves out drift and dirt: only the camera's noise is left."""
    return np.zeros((1, size, size))


def ball(size: int) -> np.ndarray:
    """A ball pressed in, the gel rising smoothly around it. Leaves out the bulge of displaced gel."""
    return _ball(size)[None]


def seal(size: int) -> np.ndarray:
    """An embossed seal: a raised border and a star. Leaves out that gel cannot follow into narrow corners."""
    return _seal(size)[None]


def ring(size: int) -> np.ndarray:
    """A ring of round wire. Leaves out that the gel inside the ring is pressed in too."""
    return _ring(size)[None]


def deep(size: int) -> np.ndarray:
    """One dome as deep as the default depth range, a quarter of the grid. Leaves out any body's shape."""
    return dome(size, size / 4)[None]


def contacts(size: int) -> np.ndarray:
    """Eight contacts, 3 to 18 pixels deep at N = 128. Leaves out motion: no frame follows from the last."""
    peg = _strokes(size, [(-0.16, 0.1), (0.14, -0.12)])
    letters = np.minimum(
        _strokes(size, [(-0.27, -0.16), (-0.05, -0.16), (-0.16, -0.16), (-0.16, 0.18)]),
        _strokes(size, [(0.07, 0.17), (0.07, -0.16), (0.16, -0.14), (0.23, 0.0), (0.16, 0.15), (0.07, 0.17)]),
    )
    shallow = size * _cap(_point(size, -0.13, 0.16), 3 / 128, 0.5)
    trio = size * np.maximum.reduce(
        [_cap(_point(size, x, y), 9 / 128, 0.9) for x, y in ((-0.2, -0.16), (0.21, -0.1), (-0.02, 0.22))]
    )
    return np.stack(
        [
            shallow,
            _seal(size),
            size * _ridge(letters, 4 / 128, 0.058),
            _ring(size),
            trio,
            _ball(size),
            size * _cap(peg, 14 / 128, 0.9),
            size * _cap(_point(size, 0.04, 0.03), 18 / 128, 0.9),
        ]
    )


SCENES: dict[str, Callable[[int], np.ndarray]] = {
    scene.__name__: scene for scene in (contacts, ball, seal, ring, deep, flat)
}
"""Scenes by name: size to height maps, float64 (frames, N, N) in grid pixels."""
