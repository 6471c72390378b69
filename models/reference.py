# SPDX-License-Identifier: Apache-2.0
"""The pipeline in double precision: what the hardware is measured against."""

from __future__ import annotations

import numpy as np
from scipy.fft import dctn, dstn, idctn, idstn

from models.calibration import Calibration
from models.configuration import Configuration
from models.divergence import divergence
from models.flat_field import flat_codes, reference_gains


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
    return calibration.table[red, green, blue]


def gains(no_contact: np.ndarray, config: Configuration) -> np.ndarray:
    """1 / reference at each pixel: of means over blocks, interpolated between their centres, constant beyond them.

    Parameters
    ----------
    no_contact : array (..., rows, cols, 3): one or more frames of the grid

    Returns
    -------
    float64 array (rows, cols, 3)
    """
    block = 1 << config.reference_block_log2
    rows, columns = config.reference_nodes
    frame = no_contact.reshape(-1, *no_contact.shape[-3:]).mean(axis=0)[: rows * block, : columns * block]
    found = 1 / frame.reshape(rows, block, columns, block, 3).mean(axis=(1, 3))
    for axis, pixels in ((0, config.rows), (1, config.columns)):
        nodes = found.shape[axis]
        at = np.clip((np.arange(pixels) + 0.5) / block - 0.5, 0, nodes - 1)
        weights = np.maximum(0, 1 - np.abs(at[:, None] - np.arange(nodes)))
        found = np.moveaxis(np.tensordot(weights, found, (1, axis)), 0, axis)
    return found


def slopes_of(frames: np.ndarray, calibration: Calibration, config: Configuration) -> np.ndarray:
    """Slopes by the model that a configuration takes: of the table's 8-bit colours, or of unrounded deviations.

    Returns
    -------
    float64 array (..., rows, cols, 2): dz/dx along the columns, dz/dy down the rows, in pixels per pixel
    """
    if config.gradient_model == "quadratic":
        assert calibration.reference is not None
        deviation = frames * gains(calibration.reference, config) - 1
        return quadratic_slopes(deviation, calibration, calibration.pixel_pitch_mm)
    if config.flat_field:
        frames = flat_codes(frames, reference_gains(calibration, config), config)
    return slopes(frames, calibration)


def quadratic_slopes(deviation: np.ndarray, calibration: Calibration, pixel_pitch_mm: float) -> np.ndarray:
    """Slopes by the calibration's quadratics.

    Parameters
    ----------
    deviation : float array (..., rows, cols, 3), I / ref - 1: frames * gains - 1
    pixel_pitch_mm : float
        Of the grid.

    Returns
    -------
    float64 array (..., rows, cols, 2): dz/dx along the columns, dz/dy down the rows, in pixels per pixel
    """
    assert calibration.coefficients is not None
    rows, columns = deviation.shape[-3:-1]
    terms = quadratic_terms(rows, columns, pixel_pitch_mm)
    return np.einsum("...rcn,ant,rct->...rca", deviation, calibration.coefficients, terms, optimize=True)


def quadratic_terms(rows: int, columns: int, pixel_pitch_mm: float) -> np.ndarray:
    """1, x, y, x^2, x y, y^2 at each pixel, in mm from the picture's centre: float64 (rows, cols, 6)."""
    y, x = np.indices((rows, columns), dtype=np.float64)
    x, y = (x - (columns - 1) / 2) * pixel_pitch_mm, (y - (rows - 1) / 2) * pixel_pitch_mm
    return np.stack((np.ones_like(x), x, y, x * x, x * y, y * y), axis=-1)


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


def depth_of(frames: np.ndarray, calibration: Calibration, config: Configuration) -> np.ndarray:
    """The same by the gradient model of a configuration, `slopes_of`."""
    return solve(divergence(slopes_of(frames, calibration, config), config.neumann), config.neumann)
