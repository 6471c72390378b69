# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/quadratic_gradient.sv: slopes from a colour's deviation, linear in the three colours.

    slope of an axis = sum over red, green, blue of C[axis][colour](column, row) * deviation[colour]

Every C is a quadratic in column c and row r, kept as six words that are integers, 32 bits signed with 28 fraction bits:

    C = A + B c + D c (c - 1) / 2 + E r + F r (r - 1) / 2 + H c r

so that it runs along the raster by additions alone: v += dv, dv += D from pixel to pixel; at a new row v0 += e,
e += F, dv0 += H, and v = v0, dv = dv0; a frame begins with v0 = A, dv0 = B, e = E. Its upper 18 bits (14 fraction
bits) are multiplied: A carries half of what is cut off, so cutting rounds. The sum of the three products, 34 bits with
26 fraction bits, is rounded half to even and saturated to the gradient's format (`Configuration.gradient`), whose unit
the words carry. That the words stay within 32 bits all over the grid is checked here, not in hardware.
"""

from __future__ import annotations

import numpy as np

from models.calibration import Calibration
from models.configuration import COLOUR_COEFFICIENT, DEVIATION, POLYNOMIAL, Configuration
from models.errors import InputError
from models.round_saturate import Monitor, round_saturate

TERMS = ("A", "B", "D", "E", "F", "H")
DROPPED = POLYNOMIAL.fraction - COLOUR_COEFFICIENT.fraction  # bits of a coefficient that are not multiplied


def polynomial_words(calibration: Calibration, config: Configuration, pixel_pitch_mm: float) -> np.ndarray:
    """The words of a calibration's quadratics on a grid.

    Parameters
    ----------
    pixel_pitch_mm : float
        Of the grid.

    Returns
    -------
    int64 array (2, 3, 6): dz/dx, dz/dy by red, green, blue by `TERMS`

    Raises
    ------
    InputError
        The calibration holds no quadratics, or their words do not fit.
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
    unit = config.gradient_lsb * 2.0**config.gradient.fraction  # what the gradient's code 2**fraction stands for
    scale = 2.0**POLYNOMIAL.fraction / unit
    wanted = {term: value * scale for term, value in exact.items()}
    words = {term: np.rint(wanted[term]) for term in "DFH"}
    # Rounding of the second differences adds up over a row: the first differences and A take back what a plane can.
    off = {term: words[term] - wanted[term] for term in "DFH"}
    words["B"] = np.rint(wanted["B"] - off["D"] * (config.columns - 2) / 2 - off["H"] * v)
    words["E"] = np.rint(wanted["E"] - off["F"] * (config.rows - 2) / 2 - off["H"] * u)
    middle = off["D"] * u * u / 3 + off["F"] * v * v / 3  # half way between the ends and the middle of the parabolas
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
    """What is multiplied, by pixel: int64 (2, 3, rows, columns), `COLOUR_COEFFICIENT`."""
    wide = _evaluate(words, config.rows, config.columns)
    half = np.int64(1) << (POLYNOMIAL.width - 1)
    wrapped = ((wide + half) & (2 * half - 1)) - half  # as the registers would
    return wrapped >> DROPPED


def _evaluate(words: np.ndarray, rows: int, columns: int) -> np.ndarray:
    """The quadratics all over the grid, exact: (2, 3, rows, columns)."""
    a, b, d, e, f, h = (np.moveaxis(words, -1, 0)[term][..., None, None] for term in range(len(TERMS)))
    c, r = np.arange(columns), np.arange(rows)[:, None]
    return a + b * c + d * (c * (c - 1) // 2) + e * r + f * (r * (r - 1) // 2) + h * (c * r)


def quadratic_gradient(
    deviation: np.ndarray, words: np.ndarray, config: Configuration, monitor: Monitor | None = None
) -> np.ndarray:
    """Slope codes: int64 (..., rows, columns, 3) of `DEVIATION` to int64 (..., rows, columns, 2) of config.gradient."""
    coefficients = coefficient_map(words, config)
    total = np.einsum("...rcn,anrc->...rca", deviation, coefficients)
    drop = DEVIATION.fraction + COLOUR_COEFFICIENT.fraction - config.gradient.fraction
    return round_saturate(total, drop, config.gradient.width, monitor, "quadratic_gradient")
