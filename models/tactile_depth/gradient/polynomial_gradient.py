# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/gradient/polynomial_gradient.sv: slopes, linear in the deviations of three colours.

    slope of an axis = sum over red, green, blue of C[axis][colour](column, row) * deviation[colour]

Every C is a quadratic in column c and row r, kept as six words that are integers, 32 bits signed with 28 fraction bits:

    C = A + B c + D c (c - 1) / 2 + E r + F r (r - 1) / 2 + H c r

so that the hardware computes C along the raster by additions only: v += dv, dv += D from pixel to pixel; at a new row
v0 += e, e += F, dv0 += H, and v = v0, dv = dv0; a frame begins with v0 = A, dv0 = B, e = E. The upper 18 bits of v (14
fraction bits) are multiplied. A includes half of the last bit that is kept, so that dropping the lower bits rounds. The
sum of the three products, 37 bits with 29 fraction bits, is rounded half to even and saturated to the gradient's format
(`Configuration.gradient`), whose unit the words have. This module, not the hardware, checks that the words stay within
32 bits over the whole grid.
"""

from __future__ import annotations

import numpy as np

from tactile_depth.common.td_round_saturate import Monitor, round_saturate
from tactile_depth.configuration import COLOUR_COEFFICIENT, DEVIATION, POLYNOMIAL, Configuration
from tactile_depth.errors import InputError
from tactile_depth.sensor import Sensor

LATENCY = 11

TERMS = ("A", "B", "D", "E", "F", "H")
DROPPED = POLYNOMIAL.fraction - COLOUR_COEFFICIENT.fraction  # bits of a coefficient that are not multiplied


def polynomial_words(calibration: Sensor, config: Configuration, pixel_pitch_mm: float) -> np.ndarray:
    """Return the words of a calibration's quadratics on a grid.

    Parameters
    ----------
    pixel_pitch_mm : float
        Millimetres per grid pixel.

    Returns
    -------
    int64 array (2, 3, 6): dz/dx, dz/dy by red, green, blue by `TERMS`

    Raises
    ------
    InputError
        The calibration has no quadratics, or their words do not fit.
    """
    if calibration.coefficients is None:
        raise InputError(f"{calibration.name}: no `coefficients` in it: the quadratic model needs them")
    one, x, y, xx, xy, yy = np.moveaxis(calibration.coefficients, -1, 0)
    p = pixel_pitch_mm
    u, v = (config.columns - 1) / 2, (config.rows - 1) / 2  # the picture's centre
    exact = {
        "A": one - x * p * u - y * p * v + p * p * (xx * u * u + xy * u * v + yy * v * v),
        "B": x * p - p * p * (2 * xx * u + xy * v) + xx * p * p,
        "D": 2 * xx * p * p,
        "E": y * p - p * p * (2 * yy * v + xy * u) + yy * p * p,
        "F": 2 * yy * p * p,
        "H": xy * p * p,
    }
    unit = config.gradient_lsb * 2.0**config.gradient.fraction  # slope of the gradient's code 2**fraction
    scale = 2.0**POLYNOMIAL.fraction / unit
    wanted = {term: value * scale for term, value in exact.items()}
    words = {term: np.rint(wanted[term]) for term in "DFH"}
    # Rounding errors of the second differences add up over a row. B, E and A compensate the part that a plane can.
    off = {term: words[term] - wanted[term] for term in "DFH"}
    words["B"] = np.rint(wanted["B"] - off["D"] * (config.columns - 2) / 2 - off["H"] * v)
    words["E"] = np.rint(wanted["E"] - off["F"] * (config.rows - 2) / 2 - off["H"] * u)
    middle = off["D"] * u * u / 3 + off["F"] * v * v / 3  # mean of the remaining parabolas
    words["A"] = np.rint(wanted["A"] + off["H"] * u * v + middle) + (1 << (DROPPED - 1))
    stacked = np.stack([words[term] for term in TERMS], axis=-1)
    limit = POLYNOMIAL.limit * 2.0**POLYNOMIAL.fraction
    largest = max(np.abs(stacked).max(), np.abs(_evaluate(stacked, config.rows, config.columns)).max())
    if not largest < limit:
        raise InputError(
            f"{calibration.name}: `coefficients` reach {largest / limit * POLYNOMIAL.limit:.3g} on a grid of "
            f"{config.rows} x {config.columns} pixels: accepted is less than {POLYNOMIAL.limit:g}"
        )
    return stacked.astype(np.int64)


def coefficient_map(words: np.ndarray, config: Configuration) -> np.ndarray:
    """Return the coefficients that multiply each pixel, int64 (2, 3, rows, columns), format `COLOUR_COEFFICIENT`."""
    return coefficients(words, config.rows, config.columns, POLYNOMIAL.width, COLOUR_COEFFICIENT.width)


def coefficients(words: np.ndarray, rows: int, columns: int, word_width: int, width: int) -> np.ndarray:
    """Return the upper `width` bits of the quadratics modulo 2**word_width, int64 (2, 3, rows, columns)."""
    half = np.int64(1) << (word_width - 1)
    wrapped = ((_evaluate(words, rows, columns) + half) & (2 * half - 1)) - half  # as in the registers
    return wrapped >> (word_width - width)


def _evaluate(words: np.ndarray, rows: int, columns: int) -> np.ndarray:
    """Return the exact values of the quadratics over the grid: (2, 3, rows, columns)."""
    a, b, d, e, f, h = (np.moveaxis(words, -1, 0)[term][..., None, None] for term in range(len(TERMS)))
    c, r = np.arange(columns), np.arange(rows)[:, None]
    return a + b * c + d * (c * (c - 1) // 2) + e * r + f * (r * (r - 1) // 2) + h * (c * r)


def polynomial_gradient(
    deviation: np.ndarray, words: np.ndarray, config: Configuration, monitor: Monitor | None = None
) -> np.ndarray:
    """Return slope codes: int64 (..., rows, columns, 3) of `DEVIATION` to int64 (..., rows, columns, 2).

    Slope codes have the format `config.gradient`.

    Parameters
    ----------
    words : int64 array (2, 3, 6) of `polynomial_words`, or (2, 3, rows, columns) of `coefficient_map`
    """
    drop = gradient_parameters(config)["Drop"]
    coefficients = words if words.ndim == 4 else coefficient_map(words, config)
    return slope_codes(deviation, coefficients, drop, config.gradient.width, monitor)


def slope_codes(
    deviation: np.ndarray, coefficients: np.ndarray, drop: int, width: int, monitor: Monitor | None = None
) -> np.ndarray:
    """Return slope codes from deviations and coefficients (2, 3, rows, columns) of any word lengths."""
    red, green, blue = np.moveaxis(deviation, -1, 0)
    slopes = np.empty((2, *deviation.shape[:-1]), np.int64)
    for slope, (of_red, of_green, of_blue) in zip(slopes, coefficients, strict=True):
        np.multiply(red, of_red, out=slope)
        slope += green * of_green
        slope += blue * of_blue
    return round_saturate(np.moveaxis(slopes, 0, -1), drop, width, monitor, "polynomial_gradient")


def gradient_parameters(config: Configuration) -> dict[str, int]:
    """Parameters of hdl/gradient/polynomial_gradient.sv."""
    return {
        "Width": config.gradient.width,
        "DeviationWidth": DEVIATION.width,
        "CoeffWidth": COLOUR_COEFFICIENT.width,
        "WordWidth": POLYNOMIAL.width,
        "Drop": DEVIATION.fraction + COLOUR_COEFFICIENT.fraction - config.gradient.fraction,
    }
