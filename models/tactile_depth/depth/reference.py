# SPDX-License-Identifier: Apache-2.0
"""The pipeline in double precision, the reference for the errors of the hardware."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.fft import dctn, dstn, idctn, idstn

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.flat_field import PixelGains, hold_dark, pixel_gains, reference_gains
from tactile_depth.chip.limits import DARKEST_LOG2, LIGHT_GAIN
from tactile_depth.chip.poisson.divergence import divergence
from tactile_depth.chip.poisson.transform.orders import read_only
from tactile_depth.sensor.sensor import Sensor, grid_terms


def eigenvalues(size: int, neumann: bool = False) -> np.ndarray:
    """Return the eigenvalues 2 (cos(k pi / N) - 1) of the second difference with zero half a pixel outside, k = 1..N.

    Neumann: the slope at the edge is zero, and k = 0..N-1.

    Returns
    -------
    float64 array (N,), by mode of scipy's DST-II (Neumann: DCT-II)
    """
    first = 0 if neumann else 1
    return 2 * (np.cos(np.arange(first, size + first) * np.pi / size) - 1)


def slopes(frames: np.ndarray, calibration: Sensor) -> np.ndarray:
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
    """Return 1 / reference at each pixel, interpolated between block means and constant beyond the outer block centres.

    Gains are limited to the full scale of the hardware's gains; `Tables.dead` marks the limited pixels.

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
    means = frame.reshape(rows, block, columns, block, 3).mean(axis=(1, 3))
    found = 1 / np.maximum(means, 2.0**DARKEST_LOG2)
    for axis, pixels in ((0, config.rows), (1, config.columns)):
        nodes = found.shape[axis]
        at = np.clip((np.arange(pixels) + 0.5) / block - 0.5, 0, nodes - 1)
        weights = np.maximum(0, 1 - np.abs(at[:, None] - np.arange(nodes)))
        found = np.moveaxis(np.tensordot(weights, found, (1, axis)), 0, axis)
    return found


@dataclass(frozen=True)
class Tables:
    """Tables between colours and slopes, computed once by `slope_tables` for all frames of a configuration.

    Attributes
    ----------
    gains : float64 array (rows, cols, 3), or None
        Models of polynomials: 1 / reference at each pixel.
    coefficients : float64 array (2, 3, rows, cols), or None
        Models of polynomials: slope of a pixel per deviation of each colour.
    dead : bool array (rows, cols), or None
        Models of polynomials: pixels where the reference is too dark, which repeat the pixel before them; None without
        such pixels.
    corrections : float64 array (16, 16, 16, 2), or None
        Model `cubic`: added to the slopes by colour.
    table_gains : PixelGains, or None
        Model `lut` with `flat_field`: gains of every pixel.
    """

    gains: np.ndarray | None = None
    coefficients: np.ndarray | None = None
    dead: np.ndarray | None = None
    corrections: np.ndarray | None = None
    table_gains: PixelGains | None = None


def slope_tables(calibration: Sensor, config: Configuration, rest: np.ndarray | None = None) -> Tables:
    """Compute the tables of a calibration on its grid; `rest`: colours in place of its reference, of any type."""
    calibration.check(config)
    if config.polynomials:
        assert calibration.reference is not None
        held = calibration.polynomials(config.gradient_model)
        coefficients = polynomials_at_pixels(config.rows, config.columns, held, calibration.pixel_pitch_mm)
        dead = pixel_gains(reference_gains(calibration, config), config).dead
        corrections = calibration.corrections if config.gradient_model == "cubic" else None
        colours = calibration.reference if rest is None else rest
        return Tables(gains(colours, config), coefficients, dead if dead.any() else None, corrections)
    if config.flat_field:
        return Tables(table_gains=pixel_gains(reference_gains(calibration, config), config))
    return Tables()


def slopes_of(
    frames: np.ndarray,
    calibration: Sensor,
    config: Configuration,
    tables: Tables | None = None,
    light: np.ndarray | None = None,
) -> np.ndarray:
    """Return slopes by the gradient model of a configuration: from 8-bit colours, or from unrounded deviations.

    Parameters
    ----------
    tables : Tables
        `slope_tables` of the same calibration and configuration, for many calls; by default computed here.
    light : int64 array (..., 3)
        Light gains of each frame, as the hardware has them; by default 1.

    Returns
    -------
    float64 array (..., rows, cols, 2): dz/dx along the columns, dz/dy down the rows, in pixels per pixel
    """
    if tables is None:
        tables = slope_tables(calibration, config)
    if tables.coefficients is not None:
        deviation = frames * tables.gains
        if light is not None:
            deviation *= light[..., None, None, :] * LIGHT_GAIN.lsb
        deviation -= 1
        if tables.dead is not None:
            deviation = hold_dark(deviation, np.broadcast_to(tables.dead, deviation.shape[:-1]), 0)
        slopes_by_position = weighted(deviation, tables.coefficients)
        if tables.corrections is None:
            return slopes_by_position
        bins = len(tables.corrections)
        red, green, blue = np.moveaxis(np.rint((deviation + 1) * bins / 2).astype(int).clip(0, bins - 1), -1, 0)
        return slopes_by_position + tables.corrections[red, green, blue]
    if tables.table_gains is not None:
        frames = tables.table_gains.codes(frames)
    return slopes(frames, calibration)


def weighted(deviation: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """Return weighted sums over the colours: (..., rows, cols, 3) by (2, 3, rows, cols) to (..., rows, cols, 2)."""
    red, green, blue = np.moveaxis(deviation, -1, 0)
    slopes = [red * of_red + green * of_green + blue * of_blue for of_red, of_green, of_blue in coefficients]
    return np.moveaxis(np.stack(slopes), 0, -1)


def polynomials_at_pixels(rows: int, columns: int, coefficients: np.ndarray, pixel_pitch_mm: float) -> np.ndarray:
    """Return the values of polynomials (2, 3, terms) at each pixel: float64 (2, 3, rows, cols)."""
    terms = pixel_terms(rows, columns, pixel_pitch_mm)[..., : coefficients.shape[-1]]
    return np.einsum("ant,rct->anrc", coefficients, terms)


def pixel_terms(rows: int, columns: int, pixel_pitch_mm: float) -> np.ndarray:
    """Return `position_terms` at each pixel, from the picture's centre: float64 (rows, cols, 10)."""
    row, column = np.indices((rows, columns), dtype=np.float64)
    return grid_terms(row, column, (rows, columns), pixel_pitch_mm)


@cache
def _divisor(rows: int, cols: int, neumann: bool) -> np.ndarray:
    """Return the eigenvalues of the Laplacian, float64 (rows, cols), with infinity in place of 0 for zero mean."""
    total = eigenvalues(rows, neumann)[:, None] + eigenvalues(cols, neumann)
    return read_only(np.where(total == 0, np.inf, total))


def solve(f: np.ndarray, neumann: bool = False) -> np.ndarray:
    """Return the depth whose five-point Laplacian is `f`, zero half a pixel outside the frame.

    Neumann: the depth has zero slope at the frame's edge, and zero mean.

    Parameters
    ----------
    f : array (..., rows, cols), divergence of the slopes, per grid pixel

    Returns
    -------
    float64 array (..., rows, cols), in grid pixels
    """
    rows, cols = f.shape[-2:]
    forward, inverse = (dctn, idctn) if neumann else (dstn, idstn)
    modes = forward(f, type=2, axes=(-2, -1)) / _divisor(rows, cols, neumann)
    return inverse(modes, type=2, axes=(-2, -1), overwrite_x=True)


def depth(frames: np.ndarray, calibration: Sensor, neumann: bool = False) -> np.ndarray:
    """Return the depth of frames by slopes, divergence and solve.

    Parameters
    ----------
    frames : uint8 array (..., rows, cols, 3), RGB

    Returns
    -------
    float64 array (..., rows, cols), in grid pixels, positive pressed in
    """
    return solve(divergence(slopes(frames, calibration), neumann), neumann)
