# SPDX-License-Identifier: Apache-2.0
"""Frames of the grid from pictures, as the hardware takes them: averaged as they are, or through a camera's format."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactile_depth.base.errors import InputError, Part
from tactile_depth.chip.camera.camera_front_end import camera_front_end
from tactile_depth.chip.camera.pixel_format import photograph
from tactile_depth.chip.camera_configuration import CameraChoice, CameraConfiguration
from tactile_depth.chip.resampling import Resampling, resampling

LARGEST_COLUMNS = 128  # of a grid that is chosen for pictures


@dataclass(frozen=True)
class GridSampler:
    """Takes pictures of one size to a grid.

    Attributes
    ----------
    scale : float
        Pixels of the picture per grid pixel.
    origin : (row, column)
        First pixel of the picture that the grid covers.
    plan : Resampling, or None
        Averages the pictures as they are.
    camera : CameraConfiguration, or None
        The pictures are converted to what this camera sends, and then taken as the camera block takes them.
    """

    scale: float
    origin: tuple[int, int]
    plan: Resampling | None
    camera: CameraConfiguration | None

    def words(self, picture: np.ndarray) -> np.ndarray:
        """Return what the camera sends for a picture, uint32 (rows, columns)."""
        assert self.camera is not None
        return photograph(picture, self.camera)

    def frame(self, picture: np.ndarray) -> np.ndarray:
        """Return the frame of the grid for a picture, uint8 (rows, columns, 3)."""
        if self.camera is not None:
            return camera_front_end(self.words(picture), self.camera)
        assert self.plan is not None
        return np.rint(self.plan.average(picture)).astype(np.uint8)


def picture_grid(picture: tuple[int, int], solver: str = "tridiagonal", least_ratio: int = 1) -> tuple[int, int]:
    """Return rows and columns of the grid that covers pictures (rows, columns): 96 x 128 for pictures of 4:3.

    Columns are the largest power of two up to 128 of which each is `least_ratio` camera pixels or more. For the
    spectral solver the grid is square.
    """
    rows, columns = picture
    most = min(LARGEST_COLUMNS, (columns if solver == "tridiagonal" else min(rows, columns)) // least_ratio)
    across = 1 << (max(most, 1).bit_length() - 1)
    return (round(across * rows / columns) if solver == "tridiagonal" else across), across


def grid_sampler(
    name: Part, picture: tuple[int, int], grid: tuple[int, int], choice: CameraChoice | None = None
) -> GridSampler:
    """Return the way from pictures to a grid, (rows, columns) each; `name` names the pictures in errors."""
    if picture[0] < grid[0] or picture[1] < grid[1]:
        (height, width), (rows, columns) = picture, grid
        problem = f": {width} x {height} pixels (columns x rows) are smaller than the grid of {columns} x {rows}"
        raise InputError(name, problem, remedy="give larger pictures or a smaller grid")
    if choice is not None:
        camera = choice.on(picture, grid)
        x, y = camera.crop[:2]
        return GridSampler(float(camera.ratio), (y, x), None, camera)
    plan = resampling(picture, grid)
    return GridSampler(plan.scale, plan.origin, plan, None)
