# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/gradient/polynomial_gradient.sv: slopes, linear in the deviations, and a correction.

    slope of an axis = sum over red, green, blue of C[axis][colour](column, row) * deviation[colour] + correction[axis]

Every C is a polynomial of third degree in column c and row r, of second degree in the model `quadratic`. It is kept as
ten words, the differences at a frame's first pixel, 32 bits signed:

    C = A + B c + D c2 + T c3 + E r + F r2 + U r3 + H c r + G c r2 + W c2 r    x2 = x (x - 1) / 2, x3 = x2 (x - 2) / 3

so that the hardware computes C along the raster by additions only. T, U, G and W, which add up most, have 32 fraction
bits up to a side of 128 pixels, more on larger grids (`fine_bits`), the others 28; sums have as many. The upper 18 bits
of C (14 fraction bits) are multiplied. A includes half of the last bit that is kept, so that dropping the lower bits
rounds. Corrections, of the model `cubic`, come from a table by colour (`gradient_lookup`); their unit is 1/256 of the
configuration's largest slope. The sum of the three products, 37 bits with 29 fraction bits, and the correction is
rounded half to even and saturated to the gradient's format (`Configuration.gradient`), whose unit the words have. This
module, not the hardware, checks that the words fit, and C stays within its range over the whole grid. Faint colours
need coefficients of 8 and more: all these fraction bits are then fewer (`Configuration.coefficient_limit`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from tactile_depth.base.errors import InputError
from tactile_depth.chip.calibration import Calibration
from tactile_depth.chip.common.td_banked_table import BankedTable
from tactile_depth.chip.common.td_round_saturate import Monitor, round_saturate
from tactile_depth.chip.common.td_table_port import TablePort
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.fixed_point import codes, joined
from tactile_depth.chip.gradient.gradient_lookup import gradient_lookup
from tactile_depth.chip.limits import (
    COLOUR_COEFFICIENT,
    CORRECTION_BITS,
    CORRECTION_WIDTH,
    CUBIC,
    DEVIATION,
    FINE_BITS,
    POLYNOMIAL,
)
from tactile_depth.chip.registers.register_map import TABLES
from tactile_depth.chip.resources import DISTRIBUTED, Multiplier, Parts, Words, banks

UNIT_BITS = 12  # of the unit of a correction, from its first: a correction is right within 2**-12 of itself
LATENCY = 12
NO_PIXEL = (0, 0, None)

TERMS = ("A", "B", "D", "T", "E", "F", "H", "U", "G", "W")
DEGREES = ((0, 0), (1, 0), (2, 0), (3, 0), (0, 1), (0, 2), (1, 1), (0, 3), (1, 2), (2, 1))  # of column and row, by term
IS_FINE = np.array([sum(degree) == 3 for degree in DEGREES])  # terms with `fine_bits` more fraction bits


def polynomial_words(calibration: Calibration, config: Configuration) -> np.ndarray:
    """Return the words of a calibration's polynomials on its grid.

    Returns
    -------
    int64 array (2, 3, 10): dz/dx, dz/dy by red, green, blue by `TERMS`

    Raises
    ------
    InputError
        The calibration does not have the model, or its words do not fit.
    """
    # The coefficients on the grid, in units of a word's last bit, as differences: those of third degree are rounded
    # first, and each lower degree takes up, in least squares over the grid, what the degrees above have left.
    row, column = config.samples
    basis = np.stack([_falling(column, across) * _falling(row, down) for across, down in DEGREES], axis=-1)
    form = config.polynomial
    wanted = calibration.grid_coefficients(config) / config.coefficient_unit
    basis = basis.reshape(-1, len(TERMS))
    largest = np.abs(basis).max(axis=0)
    words = np.zeros((*wanted.shape[:2], len(TERMS)), np.int64)
    left = wanted.reshape(-1, basis.shape[0]).T
    scale = np.where(IS_FINE, 2.0 ** (form.fraction + fine_bits(config)), 2.0**form.fraction)
    flat = words.reshape(-1, len(TERMS))
    for degree in (3, 2, 1, 0):
        upto = [n for n, power in enumerate(DEGREES) if sum(power) <= degree]
        exact = np.linalg.lstsq(basis[:, upto] / largest[upto], left, rcond=None)[0] / largest[upto, None]
        for n in (n for n in upto if sum(DEGREES[n]) == degree):
            flat[:, n] = np.rint(exact[upto.index(n)] * scale[n])
            left = left - np.outer(basis[:, n], flat[:, n] / scale[n])
    flat[:, 0] += 1 << (form.fraction - config.colour_coefficient.fraction - 1)
    limit = form.limit * 2.0**form.fraction
    reached = max(np.abs(words).max(), np.abs(wanted).max() * 2.0**form.fraction)
    if not reached < limit:
        raise InputError(
            f"{calibration.name}: the coefficients of {config.gradient_model} reach "
            f"{reached / limit * form.limit:.3g} on a grid of {config.rows} x {config.columns} pixels: "
            f"accepted is less than {form.limit:g}"
        )
    return words


def fine_bits(config: Configuration) -> int:
    """Return the fraction bits of words of third degree beyond those of the others."""
    least, side = FINE_BITS
    return least + 3 * math.ceil(math.log2(max(config.rows, config.columns, side) / side))


def _falling(x: np.ndarray, degree: int) -> np.ndarray:
    """Return x (x - 1) .. / degree!, which has differences of 1."""
    return np.prod([(x - k) / (k + 1) for k in range(degree)], axis=0) if degree else np.ones_like(x)


def coefficient_map(words: np.ndarray, config: Configuration) -> np.ndarray:
    """Return the coefficients that multiply each pixel, int64 (2, 3, rows, columns), format
    `Configuration.colour_coefficient`."""
    widths = (POLYNOMIAL.width, fine_bits(config), COLOUR_COEFFICIENT.width)
    return coefficients(words, config.rows, config.columns, *widths)


def coefficients(words: np.ndarray, rows: int, columns: int, word_width: int, fine_bits: int, width: int) -> np.ndarray:
    """Return the upper `width` bits of the polynomials modulo 2**(word_width + fine_bits): (2, 3, rows, columns)."""
    total = word_width + fine_bits
    half = np.int64(1) << (total - 1)
    aligned = np.where(IS_FINE, words, words << fine_bits)
    c, r = np.arange(columns), np.arange(rows)[:, None]
    c2, r2 = c * (c - 1) // 2, r * (r - 1) // 2
    falling_c, falling_r = (1, c, c2, c2 * (c - 2) // 3), (1, r, r2, r2 * (r - 2) // 3)
    with np.errstate(over="ignore"):  # as in the registers
        values = np.sum(
            [
                aligned[..., n, None, None] * (falling_c[across] * falling_r[down] * np.ones((rows, columns), np.int64))
                for n, (across, down) in enumerate(DEGREES)
            ],
            axis=0,
        )
        return (((values + half) & (2 * half - 1)) - half) >> (total - width)


def correction_codes(deviation: np.ndarray) -> np.ndarray:
    """Return 8-bit codes of colours for the table, whose middle entry has deviation 0 at its centre."""
    half_entry = 1 << DEVIATION.fraction - CORRECTION_BITS
    return (
        ((deviation + (1 << DEVIATION.fraction) + half_entry) >> DEVIATION.fraction - 7).clip(0, 255).astype(np.uint8)
    )


def correction_entries(calibration: Calibration, config: Configuration) -> np.ndarray | None:
    """Return the entries of the table of corrections, int64 (2**(3 b), 2); None unless the model is `cubic`."""
    if config.gradient_model != "cubic":
        return None
    assert calibration.corrections is not None
    return correction_units(calibration.corrections, config.gradient_limit).reshape(-1, 2)


def correction_units(corrections: np.ndarray, gradient_limit: float) -> np.ndarray:
    """Return corrections in slope as whole units, which reach half of the largest slope: int64 (...)."""
    limit = 1 << CORRECTION_WIDTH - 1
    return np.rint(corrections / correction_unit(gradient_limit)).clip(-limit, limit - 1).astype(np.int64)


def correction_unit(gradient_limit: float) -> float:
    """Return the slope of a correction of 1."""
    return gradient_limit * 2.0**-CORRECTION_WIDTH


def polynomial_gradient(
    deviation: np.ndarray,
    words: np.ndarray,
    config: Configuration,
    monitor: Monitor | None = None,
    table: np.ndarray | None = None,
) -> np.ndarray:
    """Return slope codes: int64 (..., rows, columns, 3) of `DEVIATION` to int64 (..., rows, columns, 2).

    Slope codes have the format `config.gradient`.

    Parameters
    ----------
    words : int64 array (2, 3, 10) of `polynomial_words`, or (2, 3, rows, columns) of `coefficient_map`
    table : int64 array (2**(3 b), 2), optional
        Corrections by the top b bits of red, green and blue, of `correction_entries`.
    """
    parameters = gradient_parameters(config)
    coefficients = words if words.ndim == 4 else coefficient_map(words, config)
    added = None
    if table is not None:
        bits = (len(table).bit_length() - 1) // 3
        added = gradient_lookup(correction_codes(deviation), table, bits) * parameters["CorrectionUnit"]
    return slope_codes(deviation, coefficients, parameters["Drop"], config.gradient.width, monitor, added)


def slope_codes(
    deviation: np.ndarray,
    coefficients: np.ndarray,
    drop: int,
    width: int,
    monitor: Monitor | None = None,
    added: np.ndarray | None = None,
) -> np.ndarray:
    """Return slope codes from deviations and coefficients (2, 3, rows, columns) of any word lengths.

    `added`, int64 (..., rows, columns, 2), is added to the sums of the products.
    """
    red, green, blue = np.moveaxis(deviation, -1, 0)
    slopes = np.empty((2, *deviation.shape[:-1]), np.int64)
    for slope, (of_red, of_green, of_blue) in zip(slopes, coefficients, strict=True):
        np.multiply(red, of_red, out=slope)
        slope += green * of_green
        slope += blue * of_blue
    if added is not None:
        slopes += np.moveaxis(added, -1, 0)
    return round_saturate(np.moveaxis(slopes, 0, -1), drop, width, monitor, "polynomial_gradient")


def gradient_parameters(config: Configuration) -> dict[str, int]:
    """Parameters of hdl/gradient/polynomial_gradient.sv."""
    drop = DEVIATION.fraction + config.colour_coefficient.fraction - config.gradient.fraction
    unit = correction_unit(config.gradient_limit) / config.gradient_lsb * 2.0**drop
    log2 = max(math.floor(math.log2(unit)) - UNIT_BITS + 1, 0)
    return {
        "Width": config.gradient.width,
        "DeviationWidth": DEVIATION.width,
        "CoeffWidth": COLOUR_COEFFICIENT.width,
        "WordWidth": POLYNOMIAL.width,
        "FineBits": fine_bits(config),
        "CorrectionWidth": CORRECTION_WIDTH,
        "CorrectionUnit": round(unit / 2.0**log2) << log2,
        "Drop": drop,
    }


class PolynomialGradient:
    """Tables, their port, and the pixels on their way: each valid, its position, and operands, then slopes and clips.

    Attributes
    ----------
    tables : list of BankedTable
        One for each colour, which changes over in its turn; the words are the same in all.
    started : bool
        A frame has begun since the last reset.
    """

    def __init__(self, entries: Sequence[int | None], largest: tuple[int, int], numbers: Mapping[str, int]) -> None:
        self._numbers, self._largest = numbers, largest  # rows and columns of a frame, at most
        self.tables = [BankedTable(entries) for _ in range(3)]
        self.port = TablePort(TABLES["coefficients"], (len(entries) - 1).bit_length(), numbers["WordWidth"], signed=1)
        self._index = 0  # of the word that is read
        self._clear()

    def _clear(self) -> None:
        self.started, self._ended, self._clipped = False, True, 0
        self._pixels: list[tuple[int, int, Any]] = [NO_PIXEL] * LATENCY

    def _begin(self, words: Sequence[Any]) -> None:
        """Begin a frame with these words, and forget one that is cut short."""
        if not self._ended:
            self._pixels = [(pixel[0], pixel[1], None) if pixel[0] else pixel for pixel in self._pixels]
        self.started, self._row, self._column = True, 0, 0
        self._factors = None
        if None not in words:
            width, fine, kept = (self._numbers[name] for name in ("WordWidth", "FineBits", "CoeffWidth"))
            signed = np.array(codes(joined(words, width), len(words), width), np.int64).reshape(2, 3, len(TERMS))
            self._factors = coefficients(signed, *self._largest, width, fine, kept)

    def _take(self, position: int, colours: Sequence[int]) -> tuple[int, int, Any]:
        """Return the next pixel of the frame, its operands None where they are not known."""
        if position & 3 == 2:
            self._row, self._column = self._row + 1, -1
        if position & 3 != 3:
            self._column += 1
        self._ended = position >> 2 == 3
        if self._factors is None:
            return 1, position, None
        width = self._numbers["DeviationWidth"]
        deviations = np.array([codes(joined(colours, width), 3, width)])
        return 1, position, (deviations, self._factors[:, :, self._row, self._column, None])

    def _corrected(self, pixel: tuple[int, int, Any], corrections: Sequence[int]) -> tuple[int, int, Any]:
        """Return a pixel with its slopes, and how many of them clip."""
        if pixel[2] is None:
            return pixel
        _, position, (deviation, factors) = pixel
        numbers, monitor = self._numbers, Monitor()
        width = numbers["CorrectionWidth"]
        added = np.array([codes(joined(corrections, width), 2, width)]) * numbers["CorrectionUnit"]
        ((gx, gy),) = slope_codes(deviation, factors, numbers["Drop"], numbers["Width"], monitor, added).tolist()
        return 1, position, (gx, gy, monitor.saturations.total())

    def clock(
        self, *, rst: int, en: int, table_command: int, table_bank: int, in_position: int, **pins: int
    ) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        valid, position, slopes = self._pixels[-1]
        gx, gy, _ = slopes or (None, None, None)
        out: dict[str, int | None] = {
            "out_valid": valid,
            "saturations": self._clipped,
            "table_in_use": self.tables[-1].in_use,
        }
        if valid:
            out |= {"out_position": position, "out_gx": gx, "out_gy": gy}
        free_word = self.tables[self._index // len(TERMS) % 3].free_word
        bus = self.port.clock(rst=rst, table_command=table_command, free_word=free_word)
        out["table_answer"], self._index = bus["table_answer"], bus["index"]
        starts = pins["in_valid"] and in_position & 3 == 3
        for (first, mark, _), table in zip(self._pixels, self.tables, strict=False):
            table.clock(
                rst=rst,
                en=en,
                table_bank=table_bank,
                frame_start=starts,
                change=first and mark & 3 == 3,
                read=0,
                free_write=bus["write"],
                free_write_address=bus["index"],
                free_write_word=bus["word"],
                free_read=bus["read"],
                free_read_address=bus["index"],
            )
        self._clipped = 0
        if en:
            if starts:
                self._begin(self.tables[0].banks[table_bank])
            if self._pixels[-2][0]:
                self._clipped = self._pixels[-2][2] and self._pixels[-2][2][2]
            colours = [pins[f"in_{colour}"] for colour in ("red", "green", "blue")]
            pixel = self._take(in_position, colours) if pins["in_valid"] else NO_PIXEL
            corrected = self._corrected(self._pixels[3], [pins["correction_gx"], pins["correction_gy"]])
            self._pixels = [pixel, *self._pixels[:3], corrected, *self._pixels[4:-1]]
        if rst:
            self._clear()
        return out


def parts(_config: Configuration) -> Parts:
    words = math.prod(CUBIC) // 6
    products = [Multiplier(DEVIATION.width, COLOUR_COEFFICIENT.width)] * 6
    return [Words(0), *products, *banks(POLYNOMIAL.width, words, DISTRIBUTED) * 6]
