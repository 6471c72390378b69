# SPDX-License-Identifier: Apache-2.0
"""A drawn sensor for `make budget`: heights, slopes and pictures in camera pixels, of which everything is known.

Three point lights stand around the gel in the directions of the synthetic sensor (scenes.py). The gel is matt: with
slopes g, a colour over that of the flat gel is

    I / ref = (1 + g . l / l_z) / sqrt(1 + |g|^2),   l the vector from the point to the light:

it is not linear in the slopes, and changes with the position. Left out are shadows, mixed colours, reflections.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from tactile_depth.calibrate.ball_press import BallPress
from tactile_depth.calibrate.press_pictures import PressPictures
from tactile_depth.sensor.scenes import BENCH, LIGHTS, NOISE, SENSOR_WIDTH_MM, SLOPE_LIMIT, Body, Places, taken

LIGHTS_MM, LIGHTS_ABOVE_MM = 30.0, 43.0  # from the middle of the gel: 0.7 of I / ref per unit of slope there
LEVEL = 110.0  # grey level of the flat gel in the middle
BALLS_MM = {6.31: (1.6, 1.8), 9.5: (2.0, 2.25)}  # contact radii by diameter, as of the real presses
LEVELS_OUT = 0.3  # distance, in contact radii, within which the gel beside a ball falls to 1 / e of its height
CUT = (0.2, 0.5)  # of the extent of a contact beyond the picture's edge
PLACES = ("middle", "sides", "cut by the edge")

Height = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Height in mm at positions x (1, n) and y (m, 1) in mm from the middle of the picture: (m, n)."""


def flat(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    return np.zeros(np.broadcast_shapes(x.shape, y.shape))


def heights(
    height: Height, count: tuple[int, int], step_mm: float, shift: tuple[float, float] = (0.0, 0.0)
) -> np.ndarray:
    """Return heights in mm on a grid around the middle, shifted by (rows, columns) of its pixels, float64."""
    y, x = ((np.arange(length) - (length - 1) / 2 + off) * step_mm for length, off in zip(count, shift, strict=True))
    return height(x[None, :], y[:, None])


@dataclass(frozen=True)
class DrawnSensor:
    """A sensor whose pictures have the height of the square that scenes fill.

    Attributes
    ----------
    camera : (rows, columns)
    noise : float
        Standard deviation of the camera's noise, grey levels.
    drift, white : float
        Largest relative change of the light of a picture, of all colours and of one colour beside the others.
    """

    camera: tuple[int, int] = (480, 640)
    noise: float = NOISE
    drift: float = 0.05
    white: float = 0.02

    @property
    def pitch_mm(self) -> float:
        """Millimetres per camera pixel."""
        return SENSOR_WIDTH_MM / self.camera[0]

    def slopes(self, height: Height) -> np.ndarray:
        """Return the mean slopes across each camera pixel, float64 (rows, columns, 2)."""
        rows, columns = self.camera
        across = np.diff(heights(height, (rows, columns + 1), self.pitch_mm), axis=1)
        down = np.diff(heights(height, (rows + 1, columns), self.pitch_mm), axis=0)
        return np.stack((across, down), axis=-1) / self.pitch_mm

    def levels(self, slopes: np.ndarray) -> np.ndarray:
        """Return the grey levels of a gel with these slopes, float64 (rows, columns, 3), neither rounded nor noisy."""
        y, x = (np.arange(length) - (length - 1) / 2 for length in self.camera)
        here = np.stack(np.broadcast_arrays(x[None, :], y[:, None]), axis=-1)[..., None, :] * self.pitch_mm
        towards = LIGHTS_MM * LIGHTS - here  # (rows, columns, 3, 2)
        middle, away = LIGHTS_MM**2 + LIGHTS_ABOVE_MM**2, (towards**2).sum(axis=-1) + LIGHTS_ABOVE_MM**2
        lit = 1 + (towards * slopes[..., None, :]).sum(axis=-1) / LIGHTS_ABOVE_MM
        tilt = np.sqrt(1 + (slopes**2).sum(axis=-1, keepdims=True))
        return LEVEL * (middle / away) ** 1.5 * np.maximum(lit, 0) / tilt

    def light(self, chance: np.random.Generator) -> np.ndarray:
        """Return the light of a picture over that of the reference, by chance, float64 (3,)."""
        return (1 + chance.uniform(-self.drift, self.drift)) * (1 + chance.uniform(-self.white, self.white, 3))

    def picture(self, levels: np.ndarray, chance: np.random.Generator) -> np.ndarray:
        """Return what the camera makes of grey levels, uint8."""
        return taken(levels, chance, self.noise)

    def presses(self, count: int, chance: np.random.Generator) -> PressPictures:
        """Return drawn presses of the balls, some of them cut by the edge, and the picture without contact."""
        listed = []
        reach = [length / 2 * self.pitch_mm for length in self.camera]
        for number in range(count):
            diameter = tuple(BALLS_MM)[number % len(BALLS_MM)]
            contact = chance.uniform(*BALLS_MM[diameter])
            y, x = (chance.uniform(-1, 1) * (half - contact / 2) for half in reach)
            levels = self.levels(self.slopes(ball_press(x, y, contact, diameter / 2)))
            row, column = (
                at / self.pitch_mm + (length - 1) / 2 for at, length in zip((y, x), self.camera, strict=True)
            )
            circle = (column, row, contact / self.pitch_mm)
            listed.append(BallPress(self.picture(levels, chance), diameter, circle, f"{number}"))
        background = self.picture(self.levels(self.slopes(flat)), chance)
        return PressPictures("drawn", tuple(listed), background)

    def contacts(self, bodies: int, steepest: float, chance: np.random.Generator) -> Iterator[tuple[str, Height]]:
        """Give contacts of the bench, each in the middle, at a side and cut by the edge: its place and its height.

        Parameters
        ----------
        bodies : int
            Number of bodies of the bench.
        steepest : float
            Largest slope of the calibration: bodies are pressed less deep than on the bench by what it is less than
            SLOPE_LIMIT.
        """
        side = self.camera[1] / self.camera[0] / 2  # from the middle to the edge, in heights of the picture
        at = np.linspace(-0.5, 0.5, self.camera[0])
        for number, contact in enumerate(list(BENCH.values())[:bodies]):
            depth = contact.depth * min(1, steepest / SLOPE_LIMIT)
            touched = contact.body(Places(at[None, :], at[:, None]), depth) > 0
            (left, right), (top, bottom) = (at[touched.any(axis=axis)][[0, -1]] for axis in (0, 1))
            x, y = chance.uniform(-0.5 - left, 0.5 - right), chance.uniform(-0.5 - top, 0.5 - bottom)
            beyond = chance.uniform(*CUT)
            cut = (side - right + beyond * (right - left), y)
            if number % 4 > 1:
                cut = (x, 0.5 - bottom + beyond * (bottom - top))
            beside = (chance.uniform(0.5 - right, side - right), y)
            for place, shift in zip(PLACES, ((x, y), beside, cut), strict=True):
                yield place, _placed(contact.body, depth, shift, 1 - 2 * (number % 2))


def _placed(body: Body, depth: float, shift: tuple[float, float], mirror: int) -> Height:
    """Return the height of a body of the bench in mm; `mirror` -1: left and right exchanged."""
    width, (x, y) = SENSOR_WIDTH_MM, shift
    return lambda across, down: width * body(Places(mirror * across / width - x, down / width - y), depth)


def ball_press(x_mm: float, y_mm: float, contact_mm: float, radius_mm: float) -> Height:
    """Return the height of a ball above the gel, which levels out beside the contact circle."""
    edge = np.sqrt(radius_mm**2 - contact_mm**2)
    reach = LEVELS_OUT * contact_mm
    rim = contact_mm / edge * reach

    def height(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        distance = np.hypot(x - x_mm, y - y_mm)
        ball = np.sqrt(radius_mm**2 - np.minimum(distance, contact_mm) ** 2) - edge
        return ball + rim * np.exp(-np.maximum(distance - contact_mm, 0) / reach)

    return height
