# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/contact/centroid.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common import td_divide
from tactile_depth.chip.common.td_round_saturate import round_half_even

FRACTION = 4  # fraction bits of a mean, in pixels


def position_bits(rows: int, columns: int) -> int:
    """Return the bits of a row and of a column."""
    return (max(rows, columns) - 1).bit_length()


def _quotient_bits(bits: int) -> int:
    return bits + FRACTION + 1  # one to round by


def cycles(bits: int) -> int:
    """Return the cycles from `start` to `done`: two divisions, with positions of `bits` bits."""
    return 2 * td_divide.cycles(_quotient_bits(bits))


def mean(moment: int, weight: int, bits: int) -> int:
    """Return the mean of weighted positions of `bits` bits, rounded to the nearest with ties to even.

    Raises
    ------
    ValueError
        The moment is too large for the weight.
    """
    result = td_divide.divide(moment << FRACTION + 1, weight, _quotient_bits(bits))
    if result is None:
        raise ValueError(f"a moment of {moment} is too large for a weight of {weight} and positions of {bits} bits")
    quotient, remainder = result
    return int(round_half_even(np.array(2 * quotient + (remainder != 0)), 2))


class Centroid:
    """State between two clock edges.

    Attributes
    ----------
    left : int
        Cycles until `done`, 0 where nothing is under way.
    held : dict
        Pins that stay as they are until `done`.
    """

    def __init__(self, bits: int) -> None:
        self.bits, self.left, self.means = bits, 0, [0, 0]
        self.held: dict[str, int] = {}

    def clock(self, *, rst: int, start: int, column_moment: int, row_moment: int, weight: int) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        out: dict[str, int | None] = {"done": self.left == 1}
        if out["done"]:
            out["column"], out["row"] = self.means
        self.left = max(self.left - 1, 0)
        if start:
            self.means = [mean(moment, weight, self.bits) for moment in (column_moment, row_moment)]
            self.left, self.held = cycles(self.bits), {"row_moment": row_moment, "weight": weight}
        if rst:
            self.left = 0
        return out
