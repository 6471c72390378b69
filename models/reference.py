# SPDX-License-Identifier: Apache-2.0
"""The pipeline in double precision: what the hardware is measured against."""

from __future__ import annotations

import numpy as np
from scipy.fft import dctn, dstn, idctn, idstn

from models.calibration import Calibration
from models.divergence import divergence


def eigenvalues(size: int, neumann: bool = False) -> np.ndarray:
    """Eigenvalues 2 (cos(k pi / N) - 1) of the second difference with zero half a pixel outside, k = 1..N.

    Neumann: with zero slope at the edge, k = 0..N-1.

    Returns
    -------
    float64 array (N,), by mode of scipy's DST-II (Neumann: DCT-II)
    """
    first = 0 if neumann else 1
    return 2 * (np.cos(np.arange(first, size + first) * np.pi / size) - 1)


def slopes(frames: np.ndarray, calibration: Calibration) -> np.ndarray:
    """Look slopes up in the calibration's unrounded table, by the top bits of each colour.

    Parameters
    ----------
    frames : uint8 array (..., rows, cols, 3), RGB

    Returns
    -------
    float64 array (..., rows, cols, 2): dz/dx along the columns, dz/dy down the rows, in pixels per pixel
    """
    red, green, blue = np.moveaxis(frames >> (8 - calibration.bits_per_channel), -1, 0)
    return calibration.gradient[red, green, blue]


def solve(f: np.ndarray, neumann: bool = False) -> np.ndarray:
    """Depth whose five-point Laplacian is `f`, zero half a pixel outside the frame.

    Neumann: with zero slope at the frame's edge, and zero mean.

    Parameters
    ----------
    f : array (..., rows, cols), divergence of the slopes, per grid pixel

    Returns
    -------
    float64 array (..., rows, cols), in grid pixels
    """
    rows, cols = f.shape[-2:]
    forward, inverse = (dctn, idctn) if neumann else (dstn, idstn)
    total = eigenvalues(rows, neumann)[:, None] + eigenvalues(cols, neumann)
    singular = total == 0
    modes = forward(f, type=2, axes=(-2, -1)) * ~singular / np.where(singular, 1, total)
    return inverse(modes, type=2, axes=(-2, -1))


def depth(frames: np.ndarray, calibration: Calibration, neumann: bool = False) -> np.ndarray:
    """Depth of frames: slopes, divergence, solve.

    Parameters
    ----------
    frames : uint8 array (..., rows, cols, 3), RGB

    Returns
    -------
    float64 array (..., rows, cols), in grid pixels, positive pressed in
    """
    return solve(divergence(slopes(frames, calibration), neumann), neumann)
