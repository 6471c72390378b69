# SPDX-License-Identifier: Apache-2.0
"""Pictures of a sensor whose colours follow the polynomials of a calibration exactly, drawn on the grid."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from PIL import Image

from commands.study.drawn_sensor import Height, heights
from tactile_depth.depth.reference import polynomials_at_pixels
from tactile_depth.sensor.scenes import BENCH, NOISE, Places, differences, taken
from tactile_depth.sensor.sensor import Sensor

LEVEL = 90.0  # mean grey level of the untouched gel


def exact(sensor: Sensor) -> Sensor:
    """Return a sensor without corrections by colour, so that its polynomials hold and a picture has one height."""
    assert sensor.corrections is not None
    return replace(sensor, corrections=np.zeros_like(sensor.corrections))


@dataclass(frozen=True)
class DrawnLight:
    """Light of a sensor on a grid (rows, columns); each pixel is `scale` pixels of the camera wide."""

    sensor: Sensor
    grid: tuple[int, int]
    scale: float

    @property
    def pitch_mm(self) -> float:
        return self.sensor.pixel_pitch_mm * self.scale

    @cached_property
    def untouched(self) -> np.ndarray:
        """Grey levels of the untouched gel, float64 (rows, columns, 3)."""
        planes = np.moveaxis(np.asarray(self.sensor.lighting, np.float32), -1, 0)
        size = self.grid[::-1]
        drawn = [np.asarray(Image.fromarray(plane).resize(size, Image.Resampling.BICUBIC)) for plane in planes]
        return LEVEL * np.stack(drawn, axis=-1).astype(np.float64)

    @cached_property
    def _colours_by_slope(self) -> np.ndarray:
        """Smallest deviations of the colours that give a slope of 1, float64 (rows, columns, 3, 2)."""
        held = polynomials_at_pixels(*self.grid, self.sensor.polynomials("cubic"), self.pitch_mm)
        return np.linalg.pinv(np.moveaxis(held, (0, 1), (-2, -1)))

    def heights(self, height: Height) -> np.ndarray:
        """Return heights in mm of the pixels and of one row and column beyond them, float64 (rows + 1, columns + 1)."""
        rows, columns = self.grid
        return heights(height, (rows + 1, columns + 1), self.pitch_mm, (0.5, 0.5))

    def levels(self, height: Height) -> np.ndarray:
        """Return grey levels, float64 (rows, columns, 3); the solve of their slopes is the height."""
        slopes = differences(self.heights(height)) / self.pitch_mm
        return self.untouched * (1 + (self._colours_by_slope @ slopes[..., None])[..., 0])

    def pictures(self, levels: np.ndarray, lights: Sequence[Sequence[float]], seed: int) -> np.ndarray:
        """Return pictures in lights (n, 3) relative to that of `levels`, with the camera's noise: uint8 (n, ..)."""
        return taken(levels * np.array(lights)[:, None, None], np.random.default_rng(seed), NOISE / self.scale)

    @property
    def width_mm(self) -> float:
        """Shorter side of the picture."""
        return min(self.grid) * self.pitch_mm

    def body(self, name: str, depth_mm: float, x_mm: float = 0.0) -> Height:
        """Return the height of a body of the bench."""
        width = self.width_mm
        return lambda x, y: width * BENCH[name].body(Places((x - x_mm) / width, y / width), depth_mm / width)
