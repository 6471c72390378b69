# SPDX-License-Identifier: Apache-2.0
"""Built-in contacts, and the synthetic tri-colour sensor that photographs them.

The sensor has three lights 120 degrees apart. Each colour is linear in the slope towards its light,

    I_c = REST + GAIN (lx_c gx + ly_c gy) + normal noise,   rounded to 8 bits.

The sensor leaves out effects of a real gel: shadows, light that falls off with distance, mixed colours, a lens.

The slope of a pixel is the forward difference of the height, so that divergence and solve return exactly the height
map that was drawn. All lengths scale with the grid. Bodies are drawn one row and column beyond the frame, so that a
body that the edge cuts has correct slopes at the edge.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from tactile_depth.base.errors import InputError

SENSOR_WIDTH_MM = 15.232  # 128 pixels of 0.119 mm
REST = 135.5  # middle of a 4-bit bin, so that noise does not move the colour of a flat gel to another bin
GAIN = 112.0  # grey levels per unit of slope: a slope of 1 nearly fills 8 bits
NOISE = 1.0  # standard deviation of the camera's noise, grey levels
SLOPE_LIMIT = 0.95  # largest slope of every scene
LIGHTS = np.array([(math.cos(t), math.sin(t)) for t in (math.pi / 2, math.pi * 7 / 6, math.pi * 11 / 6)])
"""Directions (lx, ly) of the red, green and blue light, 120 degrees apart, float64 (3, 2)."""


@dataclass(frozen=True)
class Press:
    """Depth and position of a press, and noise of the camera.

    Attributes
    ----------
    depth_mm : float or None
        Depth of the deepest point; None: the default of each body.
    at_mm : (float, float)
        Shift of the body along the columns and down the rows; parts outside the scene's square are cut off.
    noise : float
        Standard deviation of the camera's noise, grey levels.
    """

    depth_mm: float | None = None
    at_mm: tuple[float, float] = (0.0, 0.0)
    noise: float = NOISE


AS_EVER = Press()


@dataclass(frozen=True)
class Scene:
    """A rendered scene.

    Attributes
    ----------
    frames : uint8 array (frames, rows, columns, 3), RGB
    height : float64 array (frames, rows, columns), true depth in grid pixels, positive pressed in
    name : str
    labels : tuple of str
        One label per frame.
    """

    frames: np.ndarray
    height: np.ndarray
    name: str
    labels: tuple[str, ...]


def scene_pixel_pitch_mm(size: int) -> float:
    """Return the pitch of the grid in mm; the synthetic sensor has the same width for every grid."""
    return SENSOR_WIDTH_MM / size


SYNTHETIC_PIXEL_PITCH_MM = scene_pixel_pitch_mm(128)  # for a synthetic camera of 128 columns


def render(name: str, rows: int, columns: int = 0, seed: int = 1, press: Press = AS_EVER) -> Scene:
    """Render a scene of the registry on a grid of `rows` by `columns` (0: square).

    The scene fills the largest square in the middle of the grid; around it the gel is untouched.

    Parameters
    ----------
    seed : int
        Seed of the camera's noise.

    Raises
    ------
    InputError
        There is no scene of that name, the press is too steep for the sensor, or the scene accepts no press.
    """
    if name not in SCENES:
        raise InputError(f"unknown scene {name}: accepted are {', '.join(SCENES)}")
    columns = columns or rows
    size = min(rows, columns)
    bodies = SCENES[name]
    fixed = [label for label in bodies if label not in BENCH]
    if fixed and (press.depth_mm is not None or any(press.at_mm)):
        raise InputError(
            f"the scene {name} is what it is: a press depth and a position go with {', '.join(BENCH)} and bench"
        )
    depth = None if press.depth_mm is None else press.depth_mm / SENSOR_WIDTH_MM
    x, y = (shift / SENSOR_WIDTH_MM for shift in press.at_mm)
    drawn = np.stack([size * _draw(body, size, depth, x, y) for body in bodies.values()])
    steepest = float(np.abs(differences(drawn)).max())
    if steepest > SLOPE_LIMIT + 1e-9:
        raise InputError(
            f"the scene {name} pressed {press.depth_mm:g} mm deep has slopes of {steepest:.2f}, and the sensor sees "
            f"up to {SLOPE_LIMIT:g}: press less deep"
        )
    top, left = (rows - size) // 2, (columns - size) // 2
    margins = ((0, 0), (top, rows - size - top), (left, columns - size - left))
    slopes = np.pad(differences(drawn), (*margins, (0, 0)))
    height = np.pad(drawn[:, :-1, :-1], margins)
    return Scene(taken(_levels(slopes), np.random.default_rng(seed), press.noise), height, name, tuple(bodies))


def photograph(height: np.ndarray, seed: int = 1) -> np.ndarray:
    """Return pictures of height maps (..., N, N) in grid pixels by the synthetic sensor: uint8 (..., N, N, 3)."""
    return taken(_levels(slopes_of(height)), np.random.default_rng(seed))


def _levels(slopes: np.ndarray) -> np.ndarray:
    return REST + GAIN * slopes @ LIGHTS.T


def taken(levels: np.ndarray, chance: np.random.Generator, noise: float = NOISE) -> np.ndarray:
    """Return what a camera makes of grey levels: with noise, rounded to uint8."""
    return np.rint(levels + chance.normal(scale=noise, size=levels.shape)).clip(0, 255).astype(np.uint8)


def slopes_of(height: np.ndarray) -> np.ndarray:
    """Return forward differences along columns and rows, zero outside the frame: (..., N, N) to (..., N, N, 2)."""
    return np.stack((np.diff(height, axis=-1, append=0), np.diff(height, axis=-2, append=0)), axis=-1)


def differences(drawn: np.ndarray) -> np.ndarray:
    """Return forward differences of a drawing with an extra row and column: (..., N + 1, N + 1) to (..., N, N, 2)."""
    return np.stack((np.diff(drawn, axis=-1)[..., :-1, :], np.diff(drawn, axis=-2)[..., :-1]), axis=-1)


# Drawing. A shape is a profile of the distance from a skeleton (a point, a circle, strokes). All lengths are in widths
# of the frame.


class Places(NamedTuple):
    """Places that are drawn, from a middle: x along the columns, y down the rows."""

    x: np.ndarray
    y: np.ndarray

    def about(self, x: float, y: float) -> Places:
        """Return the places from another middle."""
        return Places(self.x - x, self.y - y)

    @property
    def radius(self) -> np.ndarray:
        """Distance from the middle."""
        return np.hypot(self.x, self.y)

    def strokes(self, corners: list[tuple[float, float]]) -> np.ndarray:
        """Return the distance from the line that joins the corners (x, y)."""
        distance = np.full(np.broadcast_shapes(self.x.shape, self.y.shape), np.inf)
        for (x0, y0), (x1, y1) in pairwise(corners):
            dx, dy, start = x1 - x0, y1 - y0, self.about(x0, y0)
            along = np.clip((start.x * dx + start.y * dy) / (dx * dx + dy * dy), 0, 1)
            distance = np.minimum(distance, np.hypot(start.x - along * dx, start.y - along * dy))
        return distance


def _star(radius: float, waist: float) -> list[tuple[float, float]]:
    """Return the closed outline of a five-pointed star."""
    turns = np.arange(11) / 10
    reach = np.where(np.arange(11) % 2, waist, radius)
    return [(r * math.sin(2 * math.pi * t), -r * math.cos(2 * math.pi * t)) for r, t in zip(reach, turns, strict=True)]


SKIRT = 0.3  # width, in radii of a round body, over which the gel rises to the flat surface as a parabola


def _cap_depth(edge_slope: float) -> float:
    """Return the depth, in radii, at which a round body's contact ends with this slope."""
    return 1 - 1 / math.hypot(1, edge_slope) + edge_slope * SKIRT / 2


def _cap(distance: np.ndarray, depth: float, radius: float) -> np.ndarray:
    """Draw a round body: circular inside the contact; outside the gel leaves it smoothly and rises to the surface."""
    from scipy.optimize import brentq  # imported here, because this import is slower than all others of a testbench

    edge_slope = brentq(lambda slope: _cap_depth(slope) - depth / radius, 0, 100) if depth > 0 else 0.0
    touching = edge_slope / math.hypot(1, edge_slope)  # lengths in radii from here to the last line
    sagitta = 1 - math.sqrt(1 - touching**2)
    rim = edge_slope * SKIRT / 2
    r = distance / radius
    body = np.sqrt(1 - np.minimum(r, touching) ** 2) - (1 - sagitta) + rim
    gel = rim * np.clip(1 - (r - touching) / SKIRT, 0, 1) ** 2
    return radius * np.where(r < touching, body, gel)


def _cap_radius(depth: float, edge_slope: float) -> float:
    """Return the radius of the body whose contact, at this depth, ends with this slope."""
    return depth / _cap_depth(edge_slope)


def _ridge(distance: np.ndarray, depth: float, half_width: float) -> np.ndarray:
    """Draw a raised cosine over the distance, with largest slope pi/2 depth / half_width."""
    return depth / 2 * (1 + np.cos(np.pi * np.minimum(distance / half_width, 1)))


def _facet(distance: np.ndarray, depth: float, slope: float) -> np.ndarray:
    """Draw a sharp body with straight flanks; its tip and the gel at its foot are rounded over FACET_ROUNDING."""
    height = depth - slope * (np.hypot(distance, FACET_ROUNDING) - FACET_ROUNDING)
    foot = slope * FACET_ROUNDING
    return np.where(height > foot, height, np.maximum(height + foot, 0) ** 2 / (4 * foot))


FACET_ROUNDING = 0.02


# The contacts of a tactile bench: functions from places about the body's middle and press depth to height. Each
# docstring names the effects that the drawing leaves out, besides those of the sensor.

Body = Callable[[Places, float], np.ndarray]
Strokes = Callable[[Places], np.ndarray]  # the distance from lines


def ball(at: Places, depth: float) -> np.ndarray:
    """Draw a ball with the gel rising smoothly around it, without the bulge of displaced gel."""
    return _cap(at.radius, depth, _cap_radius(0.09, 0.85))


def cylinder(at: Places, depth: float) -> np.ndarray:
    """Draw a cylinder on its side with rounded ends, without the sharp rims of a cut cylinder."""
    return _cap(at.strokes([(-0.16, 0.1), (0.16, -0.1)]), depth, _cap_radius(0.08, 0.85))


def cone(at: Places, depth: float) -> np.ndarray:
    """Draw a blunt cone, point down, without the gap between the gel and a sharp tip."""
    return _facet(at.radius, depth, 0.6)


def punch(at: Places, depth: float) -> np.ndarray:
    """Draw a flat punch without the pressure peak at its rim: the gel falls off as half a cosine."""
    return _ridge(np.maximum(at.radius - 0.2, 0), depth, 0.1)


def ring(at: Places, depth: float) -> np.ndarray:
    """Draw a ring of round wire; the gel inside the ring is not pressed in, unlike real gel."""
    return _cap(np.abs(at.radius - 0.26), depth, _cap_radius(0.05, 0.8))


def edge(at: Places, depth: float) -> np.ndarray:
    """Draw the straight edge of a wedge, of finite length, without its corners."""
    return _facet(at.strokes([(-0.22, -0.12), (0.22, 0.12)]), depth, 0.7)


def two_balls(at: Places, depth: float) -> np.ndarray:
    """Draw two balls side by side, without the stretch of the gel between them."""
    radius = _cap_radius(0.06, 0.85)
    return np.maximum(*(_cap(at.about(x, x / 3).radius, depth, radius) for x in (-0.17, 0.17)))


def pyramid(at: Places, depth: float) -> np.ndarray:
    """Draw a square pyramid, point down, rotated by 30 degrees, without the rounding of its four edges."""
    turn = math.radians(30)
    along = at.x * math.cos(turn) + at.y * math.sin(turn)
    across = at.y * math.cos(turn) - at.x * math.sin(turn)
    return _facet(np.maximum(np.abs(along), np.abs(across)), depth, 0.6)


# Seals. In relief the symbol is raised and touches; in intaglio the symbol is cut into a disc, and the disc touches.
# Real gel cannot follow into narrow corners; the drawings leave this out.


def _relief(strokes: Strokes) -> Body:
    """Return a body with raised strokes."""
    return lambda at, depth: _ridge(strokes(at), depth, 0.055)


def _intaglio(strokes: Strokes) -> Body:
    """Return a disc with strokes cut into it."""

    def body(at: Places, depth: float) -> np.ndarray:
        disc = _ridge(np.maximum(at.radius - 0.34, 0), depth, 0.08)
        return disc - _ridge(strokes(at), 0.7 * depth, 0.055)

    return body


def _outline(at: Places) -> np.ndarray:
    """Return the distance from the outline of a star."""
    return at.strokes(_star(0.23, 0.105))


def _cross(at: Places) -> np.ndarray:
    """Return the distance from the two bars of a cross."""
    bars = ([(-0.2, -0.05), (0.2, 0.05)], [(0.05, -0.22), (-0.05, 0.22)])
    return np.minimum(*(at.strokes(bar) for bar in bars))


def _letters(at: Places) -> np.ndarray:
    """Return the distance from the strokes of the letters T and D."""
    t = at.strokes([(-0.23, -0.13), (-0.05, -0.13), (-0.14, -0.13), (-0.14, 0.15)])
    d = at.strokes([(0.06, 0.14), (0.06, -0.13), (0.14, -0.12), (0.2, 0.0), (0.14, 0.13), (0.06, 0.14)])
    return np.minimum(t, d)


def seal(at: Places, depth: float) -> np.ndarray:
    """Draw a raised border around a slightly lower star."""
    border = _ridge(np.abs(at.radius - 0.34), depth, 0.055)
    return np.maximum(border, _ridge(at.strokes(_star(0.25, 0.115)), 11 / 13 * depth, 0.048))


@dataclass(frozen=True)
class Contact:
    """A body of the bench with its default press depth and its position, in frame widths."""

    body: Body
    depth: float
    x: float = 0.0
    y: float = 0.0


BENCH = {
    "ball": Contact(ball, 0.09, 0.03, -0.02),
    "cylinder": Contact(cylinder, 0.08, -0.01, 0.02),
    "cone": Contact(cone, 0.11, 0.02, 0.03),
    "punch": Contact(punch, 0.05, -0.03, 0.01),
    "ring": Contact(ring, 0.05, -0.02, 0.02),
    "edge": Contact(edge, 0.07, 0.01, -0.02),
    "two_balls": Contact(two_balls, 0.06, -0.01, 0.01),
    "pyramid": Contact(pyramid, 0.1, 0.02, -0.01),
    "seal": Contact(seal, 0.026),
    "star_relief": Contact(_relief(_outline), 0.03),
    "star_intaglio": Contact(_intaglio(_outline), 0.03),
    "cross_relief": Contact(_relief(_cross), 0.03, 0.02, -0.01),
    "cross_intaglio": Contact(_intaglio(_cross), 0.03, 0.01, 0.01),
    "letters_relief": Contact(_relief(_letters), 0.03),
    "letters_intaglio": Contact(_intaglio(_letters), 0.03),
}
"""The 15 contacts of the bench by name: machined indenters, then seals."""


# Scenes that are not a single body: functions from places about the frame's middle to height, in frame widths.


def flat(at: Places, depth: float) -> np.ndarray:
    """Draw no contact, without drift and dirt; only the camera adds noise."""
    return np.zeros_like(at.radius)


def deep(at: Places, depth: float) -> np.ndarray:
    """Draw one dome as deep as the default depth range, a quarter of the grid; no real body has this shape."""
    tip = (at.x[0, 1] - at.x[0, 0]) / 2  # puts the tip on a sample
    return _ridge(at.about(tip, tip).radius, depth, math.pi / 2 * depth / SLOPE_LIMIT)


def _round(places: Sequence[tuple[float, float]], depth: float, edge_slope: float) -> Contact:
    """Return balls at places (x, y) whose contacts end with a slope at this depth."""

    def body(at: Places, depth: float) -> np.ndarray:
        radius = _cap_radius(depth, edge_slope)
        return np.maximum.reduce([_cap(at.about(*place).radius, depth, radius) for place in places])

    return Contact(body, depth)


def large_letters(at: Places, depth: float) -> np.ndarray:
    """Draw the raised letters T and D."""
    t = at.strokes([(-0.27, -0.16), (-0.05, -0.16), (-0.16, -0.16), (-0.16, 0.18)])
    d = at.strokes([(0.07, 0.17), (0.07, -0.16), (0.16, -0.14), (0.23, 0.0), (0.16, 0.15), (0.07, 0.17)])
    return _ridge(np.minimum(t, d), depth, 0.058)


def peg(at: Places, depth: float) -> np.ndarray:
    """Draw a peg on its side."""
    return _cap(at.strokes([(-0.16, 0.1), (0.14, -0.12)]), depth, _cap_radius(depth, 0.9))


CONTACTS = {
    "contacts 0": _round([(-0.13, 0.16)], 3 / 128, 0.5),
    "contacts 1": BENCH["seal"],
    "contacts 2": Contact(large_letters, 4 / 128),
    "contacts 3": BENCH["ring"],
    "contacts 4": _round([(-0.2, -0.16), (0.21, -0.1), (-0.02, 0.22)], 9 / 128, 0.9),
    "contacts 5": BENCH["ball"],
    "contacts 6": Contact(peg, 14 / 128),
    "contacts 7": _round([(0.04, 0.03)], 18 / 128, 0.9),
}
"""Eight contacts, 3 to 18 pixels deep at N = 128, without motion between the frames."""


SCENES: dict[str, dict[str, Contact]] = {
    **{name: {name: contact} for name, contact in BENCH.items()},
    "bench": BENCH,
    "contacts": CONTACTS,
    "deep": {"deep 0": Contact(deep, 0.25)},
    "flat": {"flat 0": Contact(flat, 0.0)},
}
"""Scenes by name; a scene maps the labels of its frames to contacts."""


def _draw(contact: Contact, size: int, depth: float | None, x: float, y: float) -> np.ndarray:
    """Return the height of a contact in frame widths, float64 (size + 1, size + 1)."""
    side = (np.arange(size + 1) + 0.5) / size - 0.5
    at = Places(side[None, :], side[:, None]).about(contact.x, contact.y).about(x, y)
    return contact.body(at, contact.depth if depth is None else depth)


def dome(size: int, peak_px: float) -> np.ndarray:
    """Return one smooth dome (raised cosine) in the middle of the frame; a deep dome is as narrow as slopes allow.

    Parameters
    ----------
    size : int
        Rows and columns.
    peak_px : float
        Depth of the deepest point, in grid pixels.

    Returns
    -------
    float64 array (size, size), in grid pixels
    """
    widest = size / 2 - 1
    deepest = widest * SLOPE_LIMIT * 2 / math.pi
    if not 0 < peak_px <= deepest:
        raise InputError(f"a dome of {peak_px:g} pixels on a grid of {size}: accepted is up to {deepest:.4g}")
    half_width = max(math.pi / 2 * peak_px / SLOPE_LIMIT, size / 4)
    at = np.arange(size) - size / 2  # puts the tip on a sample
    return _ridge(np.hypot(at[None, :], at[:, None]), peak_px, half_width)
