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
