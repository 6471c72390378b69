# SPDX-License-Identifier: Apache-2.0
"""Resamples camera pictures to the grid by a centred crop and exact area averages."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from scipy import sparse

STRIP = 1024  # columns of a picture converted to floats at a time: 4096 x 4096 pixels would take 400 MB
SINGLE = 1 << 24  # up to here float32, which takes half the time, holds every integer

Share = tuple[Fraction, Fraction]
"""Share of the rows and of the columns of a picture, around its middle."""
WHOLE: Share = (Fraction(1), Fraction(1))


@dataclass(frozen=True)
class Resampling:
    """Centred crop to the aspect of a grid, and exact area averages over the crop.

    One grid pixel is `numerator / denominator` camera pixels wide and high, in lowest terms. Weights are integers in
    units of 1 / `denominator` camera pixels, so averages of integers are exact and the same on every machine.
    """

    rows: np.ndarray  # (grid rows, camera rows), integers as float64
    columns: np.ndarray  # (grid cols, camera cols)
    origin: tuple[int | Fraction, int | Fraction]  # first camera row and column of the crop
    numerator: int
    denominator: int

    @property
    def scale(self) -> float:
        """Camera pixels per grid pixel."""
        return self.numerator / self.denominator

    @cached_property
    def _window(self) -> tuple[slice, slice]:
        """Camera rows and columns that the averages depend on."""
        rows, columns = (np.flatnonzero(weights.any(axis=0)) for weights in (self.rows, self.columns))
        return slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)

    @cached_property
    def _sparse(self) -> dict[np.dtype, tuple[sparse.csr_array, sparse.csr_array]]:
        """Sparse weights inside the window, float32 and float64; each grid pixel covers only a few camera pixels."""
        from scipy import sparse  # imported here: half of the imports of a testbench that resamples nothing

        rows, columns = self._window
        return {
            kind: (
                sparse.csr_array(self.rows[:, rows], dtype=kind),
                sparse.csr_array(self.columns[:, columns], dtype=kind),
            )
            for kind in (np.dtype(np.float32), np.dtype(np.float64))
        }

    def average(self, images: np.ndarray) -> np.ndarray:
        """Return averages of images (..., camera rows, camera cols, channels): float64 (..., rows, cols, channels)."""
        *frames, _, _, channels = images.shape
        rows, columns = len(self.rows), len(self.columns)
        single = images.dtype == np.uint8 and np.iinfo(np.uint8).max * self.numerator**2 <= SINGLE
        kind = np.dtype(np.float32 if single else np.float64)
        row_weights, column_weights = self._sparse[kind]
        averages = np.empty((*frames, rows, columns, channels))
        for frame in np.ndindex(*frames):
            window = images[frame][self._window]
            width = window.shape[1]
            columns_first = np.empty((width, rows, channels), kind)
            for left in range(0, width, STRIP):
                strip = window[:, left : left + STRIP].astype(kind)
                by_row = row_weights @ strip.reshape(len(strip), -1)
                columns_first[left : left + STRIP] = by_row.reshape(rows, -1, channels).swapaxes(0, 1)
            totals = (column_weights @ columns_first.reshape(width, -1)).reshape(columns, -1, channels)
            np.divide(totals.swapaxes(0, 1), self.numerator**2, out=averages[frame], dtype=np.float64)
        return averages


def ratio(camera: tuple[int, int], grid: tuple[int, int], share: Share = WHOLE) -> Fraction:
    """Return the camera pixels per grid pixel, for the largest crop of a share of the camera's pictures."""
    return min(length * part / count for length, part, count in zip(camera, share, grid, strict=True))


def crop_origin(camera: tuple[int, int], grid: tuple[int, int]) -> tuple[int, int]:
    """Return the first camera row and column of the centred crop."""
    scale = ratio(camera, grid)
    top, left = (math.floor((length - count * scale) / 2) for length, count in zip(camera, grid, strict=True))
    return top, left


def resampling(camera: tuple[int, int], grid: tuple[int, int], share: Share = WHOLE) -> Resampling:
    """Return the resampling of a share of camera frames (rows, cols) to a grid (rows, cols) that is not larger.

    The crop of whole frames starts on a pixel boundary, so that a frame as wide as the grid is not blurred; that of a
    share lies exactly in the middle.
    """
    (height, width), (rows, cols) = camera, grid
    scale = ratio(camera, grid, share)
    numerator, denominator = scale.numerator, scale.denominator
    top: int | Fraction
    left: int | Fraction
    top, left = crop_origin(camera, grid)
    if share != WHOLE:
        numerator, denominator = 2 * numerator, 2 * denominator
        top, left = (height - rows * scale) / 2, (width - cols * scale) / 2

    def weights(count: int, length: int, origin: int | Fraction) -> np.ndarray:
        start = int(origin * denominator) + np.arange(count)[:, None] * numerator
        pixel = np.arange(length) * denominator
        overlap = np.minimum(start + numerator, pixel + denominator) - np.maximum(start, pixel)
        return np.maximum(overlap, 0).astype(np.float64)

    return Resampling(weights(rows, height, top), weights(cols, width, left), (top, left), numerator, denominator)
