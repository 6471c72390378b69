# SPDX-License-Identifier: Apache-2.0
"""Reads pictures of a sensor onto its grid."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from tactile_depth.base.errors import Argument, InputError, InputWarning, Part, warn
from tactile_depth.chip.resampling import WHOLE, Share
from tactile_depth.pictures.grid_sampler import GridSampler, grid_sampler, middle, picture_grid
from tactile_depth.pictures.picture_check import require_all_colours
from tactile_depth.pictures.pictures import Pictures, pictures_of
from tactile_depth.sensor.sensor import Sensor

SYNTHETIC_GRID = (128, 128)
LEAST_PART = 0.6  # of the width or height; a square shows 0.75 of pictures of 4:3
ONE_SIZE = "give pictures of one size"


def default_grid(sensor: Sensor, solver: str = "tridiagonal") -> tuple[int, int]:
    """Return rows and columns of the grid that covers the full picture of a sensor, as `picture_grid`."""
    if sensor.camera is None:
        return SYNTHETIC_GRID
    return picture_grid((sensor.camera.rows, sensor.camera.columns), solver)


def check_shape(grid: tuple[int, int], sensor: Sensor) -> None:
    """Warn of a grid that is upright where pictures of a sensor are wide, or shows a small part of them."""
    rows, columns = default_grid(sensor)
    part = grid[1] / grid[0] * rows / columns
    is_turned = (grid[0] - grid[1]) * (rows - columns) < 0
    if is_turned or (sensor.camera is not None and min(part, 1 / part) < LEAST_PART):
        side = "width" if part < 1 else "height"
        whole = grid[::-1] if is_turned else (round(grid[1] * rows / columns), grid[1])
        problem = f" is rows and columns, and shows {min(part, 1 / part):.2g} of the {side} of the pictures"
        warn(InputWarning(Argument("grid", grid), problem, remedy=("to see more give ", Argument("grid", whole))))


class Reader:
    """Reads pictures of a sensor onto a grid.

    A camera that joins pixels shows the same in a whole fraction of the rows and columns; a picture of another size
    than the first is warned of.

    Attributes
    ----------
    sensor : Sensor
        With the pixel pitch of its camera.
    share : Share
        What the sensor's camera shows of the pictures; the grid covers it.
    """

    def __init__(self, sensor: Sensor, grid: tuple[int, int], share: Share = WHOLE) -> None:
        check_shape(grid, sensor)
        self.sensor, self.share, self._grid = sensor, share, grid
        self._samplers: dict[tuple[int, int], GridSampler] = {}
        self._untouched: np.ndarray | None = None  # a picture of the reference

    def pictures(self, given: Pictures, name: Part) -> tuple[Iterator[tuple[Part, np.ndarray]], bool]:
        """Return frames on the grid, uint8 (rows, columns, 3), each with its name, and True for a single picture."""
        read, single = pictures_of(given, name)
        return ((each, self._checked(picture, each)) for each, picture in read), single

    def reference(self, given: Pictures, name: Argument, largest_log2: int) -> tuple[np.ndarray, np.ndarray]:
        """Return 1, 2, 4 .. 2**largest_log2 pictures, cut and on the grid, uint8 (frames, rows, columns, 3)."""
        read = list(pictures_of(given, name)[0])
        power_of_two_of(len(read), largest_log2, name)
        frames = np.stack([self._on_grid(picture, each) for each, picture in read])
        rows, columns, _ = read[0][1].shape
        for each, picture in read:
            if picture.shape[:2] != (rows, columns):
                size = f"{picture.shape[1]} x {picture.shape[0]}"
                problem = f": {size} pixels (columns x rows), but the first picture had {columns} x {rows}"
                raise InputError(each, problem, remedy=ONE_SIZE)
            require_all_colours(picture, picture, each)
        self._untouched = read[0][1]
        return middle(np.stack([picture for _, picture in read]), self.share), frames

    def _checked(self, picture: np.ndarray, name: Part) -> np.ndarray:
        if self._untouched is not None:
            require_all_colours(picture, self._untouched, name)
        return self._on_grid(picture, name)

    def _on_grid(self, picture: np.ndarray, name: Part) -> np.ndarray:
        size = (picture.shape[0], picture.shape[1])
        if size not in self._samplers:
            self.sensor.zoom(size, name, self.share)
            if self._samplers:
                rows, columns = next(iter(self._samplers))
                had = f"the first picture had {columns} x {rows}"
                problem = f": {size[1]} x {size[0]} pixels (columns x rows), but {had}"
                if self.sensor.camera is None:
                    raise InputError(name, problem, remedy=ONE_SIZE)
                if max(rows, size[0]) % min(rows, size[0]) or max(columns, size[1]) % min(columns, size[1]):
                    warn(InputWarning(name, problem, ", and may show another part of the gel", remedy=ONE_SIZE))
            self._samplers[size] = grid_sampler(name, size, self._grid, share=self.share)
        return self._samplers[size].frame(picture)


def power_of_two_of(count: int, largest_log2: int, name: Argument) -> None:
    """Raise InputError unless the hardware averages so many pictures."""
    if count.bit_count() != 1 or count > 1 << largest_log2:
        problem = f": {count} pictures: the hardware averages 1, 2, 4, .. {1 << largest_log2}"
        raise InputError(name, problem, remedy="give so many")
