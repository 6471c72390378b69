# SPDX-License-Identifier: Apache-2.0
"""Resamples camera pictures to the grid by a centred crop and exact area averages."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

STRIP = 1024  # columns of a picture converted to float64 at a time: 4096 x 4096 pixels would take 400 MB


@dataclass(frozen=True)
class Resampling:
    """Centred crop to the aspect of a grid, and exact area averages over the crop.

    One grid pixel is `numerator / denominator` camera pixels wide and high. Weights are integers in units of 1 /
    `denominator` camera pixels, so averages of integers are exact and the same on every machine.
    """

    rows: np.ndarray  # (grid rows, camera rows), integers as float64
    columns: np.ndarray  # (grid cols, camera cols)
    origin: tuple[int, int]  # first camera row and column of the crop
    numerator: int
    denominator: int

    @property
    def scale(self) -> float:
        """Camera pixels per grid pixel."""
        return self.numerator / self.denominator

    @cached_property
    def _sparse(self) -> tuple[sparse.csr_array, sparse.csr_array]:
        """Sparse matrices of `rows` and `columns`; each grid pixel covers only a few camera pixels."""
        return sparse.csr_array(self.rows), sparse.csr_array(self.columns)

    def average(self, images: np.ndarray) -> np.ndarray:
        """Return averages of images (..., camera rows, camera cols, channels): float64 (..., rows, cols, channels)."""
        *frames, _, width, channels = images.shape
        averages = np.empty((*frames, len(self.rows), len(self.columns), channels))
        row_weights, column_weights = self._sparse
        for frame in np.ndindex(*frames):
            columns_first = np.empty((width, len(self.rows), channels))
            for left in range(0, width, STRIP):
                strip = images[frame][:, left : left + STRIP].astype(np.float64)
                by_row = row_weights @ strip.reshape(len(strip), -1)
                columns_first[left : left + STRIP] = by_row.reshape(len(self.rows), -1, channels).swapaxes(0, 1)
            totals = (column_weights @ columns_first.reshape(width, -1)).reshape(len(self.columns), -1, channels)
            np.divide(totals.swapaxes(0, 1), self.numerator**2, out=averages[frame])
        return averages


def ratio(camera: tuple[int, int], grid: tuple[int, int]) -> tuple[int, int]:
    """Return numerator and denominator of the camera pixels per grid pixel, for the largest crop of its aspect."""
    (height, width), (rows, cols) = camera, grid
    return (height, rows) if height * cols <= width * rows else (width, cols)


def crop_origin(camera: tuple[int, int], grid: tuple[int, int]) -> tuple[int, int]:
    """Return the first camera row and column of the centred crop."""
    numerator, denominator = ratio(camera, grid)
    top, left = (
        (length * denominator - count * numerator) // (2 * denominator)
        for length, count in zip(camera, grid, strict=True)
    )
    return top, left


def resampling(camera: tuple[int, int], grid: tuple[int, int]) -> Resampling:
    """Return the resampling of camera frames (rows, cols) to a grid (rows, cols) that is not larger.

    The crop starts on a pixel boundary, so that a frame as wide as the grid is not blurred.
    """
    (height, width), (rows, cols) = camera, grid
    numerator, denominator = ratio(camera, grid)
    top, left = crop_origin(camera, grid)

    def weights(count: int, length: int, origin: int) -> np.ndarray:
        start = origin * denominator + np.arange(count)[:, None] * numerator
        pixel = np.arange(length) * denominator
        overlap = np.minimum(start + numerator, pixel + denominator) - np.maximum(start, pixel)
        return np.maximum(overlap, 0).astype(np.float64)

    return Resampling(weights(rows, height, top), weights(cols, width, left), (top, left), numerator, denominator)
