# SPDX-License-Identifier: Apache-2.0
"""Ball presses: pictures of balls of known diameter pressed into a gel, on the grid, with true slopes and depth."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.ndimage import map_coordinates

from tactile_depth.base.errors import InputError
from tactile_depth.calibrate.ball_press import BallPress, Circle
from tactile_depth.calibrate.circles import find_circle, require_circle_finder, stretched
from tactile_depth.calibrate.press_pictures import BACKGROUND, PressPictures
from tactile_depth.chip.camera_configuration import FORMATS, CameraChoice
from tactile_depth.chip.configuration import COLOURS, Configuration
from tactile_depth.chip.gradient.flat_field import captured_gains, pixel_gains, require_light
from tactile_depth.chip.gradient.light_gains import Light, settled
from tactile_depth.chip.resampling import WHOLE, Share
from tactile_depth.pictures.blocks import Rest
from tactile_depth.pictures.doubts import Warned
from tactile_depth.pictures.grid_sampler import GridSampler, grid_sampler, picture_grid
from tactile_depth.pictures.picture_check import check_picture

SMALLEST_GRID = 16  # columns
FITTED_SHARE = 0.9  # fraction of the contact's radius: beyond it the gel leaves the ball
NOTHING_TOUCHES = 2.0  # distance from the centre in contact radii: beyond it the gel is flat
AT_REST = 2.5  # distance from the centre in contact radii: beyond it depth is that of untouched gel
LARGEST_CONTACT = 0.999  # fraction of the ball's radius: slopes grow without bound towards 1
TOP_PX = 2  # radius of the top of a cap, in grid pixels
# Standard deviation of the colours in the contacts, second over first principal axis. Colour pictures of 45 real
# presses: 0.58; the same pictures in grey: 0.
ALIKE = 0.1
# Largest difference of two frames of one press, in grey levels. Noise of 4 levels in pixels of the camera: 10; the
# nearest two of 45 real presses: 26.
SAME_PRESS = 12


@dataclass(frozen=True)
class GridPress:
    """Geometry of a press on a grid; x counts along the columns, y down the rows, and the radii in heights of a pixel.

    A depth map is shifted by half a pixel up and to the left (divergence.py): it shows the centre at x + 0.5, y + 0.5.
    `aspect` is the width of a pixel over its height.
    """

    name: str
    grid: tuple[int, int]
    x: float
    y: float
    contact_radius: float
    ball_radius: float
    aspect: float = 1.0

    @property
    def cap_height(self) -> float:
        """Height of the ball's cap above its contact circle."""
        return self.ball_radius - math.sqrt(self.ball_radius**2 - self.contact_radius**2)

    @property
    def largest_slope(self) -> float:
        """Slope of the ball at the contact circle."""
        return self.contact_radius / math.sqrt(self.ball_radius**2 - self.contact_radius**2)

    @property
    def margin(self) -> float:
        """Distance from the contact circle to the nearest edge of the grid; negative if it is cut."""
        down, across = (min(at, length - 1 - at) for at, length in zip((self.y, self.x), self.grid, strict=True))
        return min(across * self.aspect, down) - self.contact_radius

    @property
    def is_central(self) -> bool:
        """True if the contact lies completely in the middle square of the grid."""
        side = min(self.grid)
        top, left = ((length - side) / 2 for length in self.grid)
        return replace(self, grid=(side, side), x=self.x - left, y=self.y - top).margin >= 0

    @cached_property
    def distance(self) -> np.ndarray:
        """Distance of each pixel from the centre in contact radii, float64 (rows, columns)."""
        rows, columns = np.indices(self.grid)
        return np.hypot((columns - self.x) * self.aspect, rows - self.y) / self.contact_radius

    @cached_property
    def slopes(self) -> np.ndarray:
        """Change of the depth from pixel to pixel, float64 (rows, columns, 2), in heights of a pixel.

        It is that of the ball in the contact, 0 elsewhere. Of square pixels it is the slope.
        """
        rows, columns = np.indices(self.grid, dtype=np.float64)
        offset = np.stack(((columns - self.x) * self.aspect, rows - self.y), axis=-1)
        squared = (offset**2).sum(axis=-1)
        touches = squared < self.contact_radius**2
        drop = np.sqrt(np.where(touches, self.ball_radius**2 - squared, 1))
        return np.where(touches[..., None], -offset * (self.aspect, 1) / drop[..., None], 0)

    @cached_property
    def _squared(self) -> np.ndarray:
        """Squared distance of each depth of a map from the centre."""
        rows, columns = np.indices(self.grid)
        return ((columns - self.x - 0.5) * self.aspect) ** 2 + (rows - self.y - 0.5) ** 2

    @cached_property
    def depth(self) -> np.ndarray:
        """Depth of the ball above the contact circle, float64 (rows, columns), NaN outside."""
        squared = self._squared
        height = np.sqrt(np.maximum(self.ball_radius**2 - squared, 0)) - (self.ball_radius - self.cap_height)
        return np.where(squared < self.contact_radius**2, height, np.nan)

    @cached_property
    def untouched(self) -> np.ndarray:
        """Depths of a map that are so far from the contact that the gel is at rest, bool (rows, columns)."""
        return self._squared > (AT_REST * self.contact_radius) ** 2

    @cached_property
    def edge(self) -> tuple[np.ndarray, np.ndarray]:
        """Points of the contact circle in a depth map: columns, rows, float64 (360,) each."""
        angle = np.linspace(0, 2 * np.pi, 360, endpoint=False)
        return (
            self.x + 0.5 + self.contact_radius / self.aspect * np.cos(angle),
            self.y + 0.5 + self.contact_radius * np.sin(angle),
        )

    def edge_depth(self, depth: np.ndarray) -> float:
        """Return the mean of a depth map (rows, columns) on the contact circle."""
        x, y = self.edge
        return float(map_coordinates(depth, [y, x], order=1, mode="nearest").mean())

    def recovered(self, depth: np.ndarray) -> float:
        """Return the ratio of recovered to true height of the cap, from a depth map (rows, columns) in grid pixels.

        A height is the mean depth within `TOP_PX` of the centre minus that on the contact circle, of the map and of the
        ball alike.
        """
        top = self._squared <= TOP_PX**2
        return float((depth[top].mean() - self.edge_depth(depth)) / np.nanmean(self.depth[top]))

    def height_rms(self, depth: np.ndarray) -> float:
        """Return the standard deviation of a depth map (rows, columns) from the ball in the contact, in grid pixels."""
        return float(np.nanstd(depth - self.depth))


@dataclass(frozen=True)
class View:
    """A press on the grid: its geometry, its picture, and the colours from the hardware's flat field.

    Attributes
    ----------
    press : GridPress
    diameter_mm : float
    frame, codes : uint8 array (rows, columns, 3)
    deviations : int64 array (rows, columns, 3), in units of `DEVIATION.lsb`, with light gains
    """

    press: GridPress
    diameter_mm: float
    frame: np.ndarray
    codes: np.ndarray
    deviations: np.ndarray

    @property
    def is_whole(self) -> bool:
        """True if the contact lies completely on the grid."""
        return self.press.margin >= 0


@dataclass(frozen=True)
class GridPresses:
    """Presses on the grid.

    Attributes
    ----------
    name : str
    views : tuple of View
    background : uint8 array (rows, columns, 3)
        Picture of the sensor without contact, in camera pixels.
    background_on_grid : uint8 array (rows, columns, 3)
    pitch_mm : float
        Millimetres per camera pixel.
    scale : float
        Camera pixels per grid pixel.
    notes : tuple of str
        One line for each press, column or line that was left out, and for the first press with each kind of doubt.
    agreement : float64 array (n, 3)
        Detected minus given circles in camera pixels: x, y, radius.
    pixel_format : str
        Pixel format of the camera that the pictures were converted for.
    aspect : float
        Width of a pixel over its height.
    circles : mapping of str to Circle
        The circles of the views in camera pixels, by the name of the press.
    left_out : tuple of str
        Names of the presses that were left out.
    ball_pitches : mapping of float to float
        Millimetres per pixel by the diameter of the ball, from presses with `ball_radius_px`.
    view : (width, height), or None
        Shares of the sensor's full picture that the pictures show; None: unknown.
    """

    name: str
    views: tuple[View, ...]
    background: np.ndarray
    background_on_grid: np.ndarray
    pitch_mm: float
    scale: float
    notes: tuple[str, ...]
    agreement: np.ndarray
    pixel_format: str = "rgb888"
    aspect: float = 1.0
    circles: Mapping[str, Circle] = field(default_factory=dict)
    left_out: tuple[str, ...] = ()
    ball_pitches: Mapping[float, float] = field(default_factory=dict)
    view: tuple[float, float] | None = None

    @property
    def grid(self) -> tuple[int, int]:
        """Rows and columns of the grid."""
        return len(self.background_on_grid), self.background_on_grid.shape[1]

    @property
    def field_of_view(self) -> str:
        """The size of the gel in the picture by the pitch, which balls of known diameter cannot check."""
        (rows, columns), part = self.background.shape[:2], "an unknown part (no crop)"
        if self.view is not None:
            part = f"{self.view[0]:.3g} of the width and {self.view[1]:.3g} of the height"
        return (
            f"{self.pitch_mm:.3g} mm per pixel: the picture shows {columns * self.pitch_mm * self.aspect:.1f} x "
            f"{rows * self.pitch_mm:.1f} mm of the gel, {part} of the sensor's full picture. Check that with a ruler: "
            "balls fit any pitch, and an error of the pitch changes heights by twice as much"
        )

    @property
    def grid_pitch_mm(self) -> float:
        """Millimetres per grid pixel."""
        return self.pitch_mm * self.scale


def to_grid(
    pictures: PressPictures,
    pitch_mm: float,
    find_circles: bool = False,
    compare_circles: bool = False,
    choice: CameraChoice | None = None,
    aspect: float = 1.0,
    grid: tuple[int, int] | None = None,
    share: Share = WHOLE,
) -> GridPresses:
    """Resample presses to a grid; `notes` names the presses left out and why, and doubts.

    Parameters
    ----------
    pitch_mm : float
        Millimetres per camera pixel, down the rows.
    find_circles : bool
        Detect circles in the pictures even if circles are given, and use the detected circles.
    compare_circles : bool
        Detect circles, use the given circles, and return the differences.
    choice : CameraChoice, optional
        Pictures are converted to what this camera sends, and then taken as its hardware takes them.
    aspect : float
        Width of a pixel over its height.
    grid : (rows, columns), optional
        By default `picture_grid`, which covers the pictures.
    share : Share
        Part of the pictures that the grid covers.
    """
    background = pictures.background
    camera = background.shape[:2]
    least = 1 if choice is None else FORMATS[choice.pixel_format].least_ratio
    rows, columns = (round(length * part) for length, part in zip(camera, share, strict=True))
    grid = grid or picture_grid((rows, columns), least_ratio=least)
    if min(grid) < SMALLEST_GRID:
        raise InputError(BACKGROUND, f": {camera[0]} x {camera[1]} pixels", accepted=f"{SMALLEST_GRID} x or more")
    is_seen = find_circles or compare_circles
    if is_seen or any(press.circle is None for press in pictures.presses):
        require_circle_finder()
    shape: dict[str, Any] = {"columns": grid[1], "rows": grid[0], "solver": "tridiagonal"}
    config = Configuration(**shape, **COLOURS)
    sampler = grid_sampler(BACKGROUND, (camera[0], camera[1]), grid, choice, share)
    rest = sampler.frame(background)
    gains = captured_gains(rest[None], config)
    require_light(gains, config, BACKGROUND)
    notes, agreement, stretches, warned = list(pictures.notes), [], [], Warned()
    geometry: list[tuple[GridPress, float]] = []
    circles: dict[str, Circle] = {}
    frames: dict[str, np.ndarray] = {}
    for press in pictures.presses:
        try:
            frame = sampler.frame(image := pictures.image(press))
            notes += map(str, warned.new(check_picture(frame, Rest.of(rest[None]), press.name).doubts))
            ball = press.diameter_mm / 2 / pitch_mm
            found = find_circle(image, background, ball, aspect) if is_seen or press.circle is None else None
            seen = None if found is None else found.circle
            stretches += [] if found is None or found.stretch is None else [found.stretch]
            given = None if press.circle is None else Circle(*press.circle)
            circle = _on_ball(press, seen if find_circles else given or seen, ball)
            at = _grid_press(press.name, circle, ball, sampler, grid, aspect)
            _require_new(press.name, frame, {"the background": rest} | frames)
        except InputError as error:
            notes.append(str(InputError(f"{error}: left out")))
            continue
        if given and seen:
            agreement.append(np.subtract(seen, given))
        geometry.append((at, press.diameter_mm))
        circles[press.name] = circle
        frames[press.name] = frame
    views = _views(geometry, np.array([*frames.values()], np.uint8).reshape(-1, *grid, 3), gains, config)
    _require_colours(views, pictures.name)
    told, differences = (*notes, *stretched(stretches)), np.array(agreement).reshape(-1, 3)
    return GridPresses(
        *(pictures.name, views, background, rest, pitch_mm, sampler.scale, told, differences),
        pixel_format="rgb888" if choice is None else choice.pixel_format,
        aspect=aspect,
        circles=circles,
        left_out=tuple(press.name for press in pictures.presses if press.name not in circles),
        ball_pitches=pictures.ball_pitches,
    )


def _on_ball(press: BallPress, circle: Circle | None, ball: float) -> Circle:
    """Return the circle of a press. Raises InputError: there is none, or it is too large for a ball of that radius."""
    if circle is None:
        raise InputError(f"{press.name}: no circle to be seen")
    if circle.radius >= LARGEST_CONTACT * ball:
        radius_mm = press.diameter_mm / 2
        contact = f"{press.name}: a contact of {circle.radius:.1f} pixels ({circle.radius / ball * radius_mm:.2f} mm)"
        ball_px = f"radius {ball:.1f} pixels ({radius_mm:.2f} mm)"
        raise InputError(f"{contact} does not lie on a ball of {ball_px}: diameter or pitch is wrong")
    return circle


def _views(
    geometry: list[tuple[GridPress, float]], stack: np.ndarray, gains: np.ndarray, config: Configuration
) -> tuple[View, ...]:
    """Return presses with their frames, uint8 (presses, rows, columns, 3), and what the hardware makes of these."""
    field, light = pixel_gains(gains, config), Light.of(config)
    codes, relative = field.codes(stack), field.ratios(stack)
    colours = light.deviations(relative, settled(relative, light)[:, None, None])
    return tuple(View(*at, *parts) for at, *parts in zip(geometry, stack, codes, colours, strict=True))


def _require_new(name: str, frame: np.ndarray, seen: Mapping[str, np.ndarray]) -> None:
    """Raise InputError if a frame shows what one of `seen` shows: a fit without it measures a press."""
    same = (other for other, by in seen.items() if np.abs(frame.astype(np.int16) - by).max() <= SAME_PRESS)
    if (other := next(same, None)) is not None:
        raise InputError(f"{name}: it shows what {other} shows")


def _require_colours(views: Sequence[View], name: str) -> None:
    """Raise InputError if all colours change alike in all contacts, as in grey pictures: they show no direction."""
    if not views:
        return
    colours = np.concatenate([view.deviations[view.press.distance < FITTED_SHARE] for view in views])
    first, second, _ = np.sqrt(np.linalg.eigvalsh(np.cov(colours.T.astype(np.float64)))[::-1].clip(0))
    if second < ALIKE * first:
        remedy = "give colour pictures of a gel that is lit in several colours"
        raise InputError(f"{name}: the colours of all presses change alike, as in grey pictures", remedy=remedy)


def _grid_press(
    name: str, circle: Circle, ball: float, sampler: GridSampler, grid: tuple[int, int], aspect: float
) -> GridPress:
    """Return the geometry of a circle and a ball's radius in camera pixels; raise InputError if it cannot be used."""
    top, left = sampler.origin
    press = GridPress(
        name,
        grid,
        (circle.x - left + 0.5) / sampler.scale - 0.5,
        (circle.y - top + 0.5) / sampler.scale - 0.5,
        circle.radius / sampler.scale,
        ball / sampler.scale,
        aspect,
    )
    if not (press.distance < FITTED_SHARE).any():
        raise InputError(f"{name}: the press is outside the picture")
    return press
