# SPDX-License-Identifier: Apache-2.0
"""Frames of the grid from pictures, as the hardware takes them: averaged as they are, or through a camera's format."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tactile_depth.base.errors import InputError, Part
from tactile_depth.chip.camera.camera_front_end import camera_front_end
from tactile_depth.chip.camera.pixel_format import photograph
from tactile_depth.chip.camera_configuration import CameraChoice, CameraConfiguration
from tactile_depth.chip.resampling import WHOLE, Resampling, Share, resampling

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
    origin: tuple[float, float]
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
    name: Part,
    picture: tuple[int, int],
    grid: tuple[int, int],
    choice: CameraChoice | None = None,
    share: Share = WHOLE,
) -> GridSampler:
    """Return the way from a share of pictures to a grid, (rows, columns) each; `name` names the pictures in errors."""
    height, width = (float(length * part) for length, part in zip(picture, share, strict=True))
    if height < grid[0] or width < grid[1]:
        used, (rows, columns) = "" if share == WHOLE else " of the part that is used", grid
        problem = f": {width:.0f} x {height:.0f} pixels (columns x rows){used} are smaller than the grid of"
        raise InputError(name, f"{problem} {columns} x {rows}", remedy="give larger pictures or a smaller grid")
    if choice is not None:
        camera = choice.on(picture, grid, share)
        x, y = camera.crop[:2]
        return GridSampler(float(camera.ratio), (y, x), None, camera)
    plan = resampling(picture, grid, share)
    return GridSampler(plan.scale, (float(plan.origin[0]), float(plan.origin[1])), plan, None)


def middle(pictures: np.ndarray, share: Share) -> np.ndarray:
    """Return a share of pictures (.., rows, columns, 3) in whole pixels."""
    cuts = (round(length * (1 - part) / 2) for length, part in zip(pictures.shape[-3:-1], share, strict=True))
    top, left = cuts
    return pictures[..., top : pictures.shape[-3] - top, left : pictures.shape[-2] - left, :]
