# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/common/td_divide.sv."""

from __future__ import annotations


def divide(numerator: int, divisor: int, quotient_bits: int) -> tuple[int, int] | None:
    """Return quotient and remainder of unsigned integers; None if the quotient does not fit into `quotient_bits`."""
    if numerator >> quotient_bits >= divisor:
        return None
    return divmod(numerator, divisor)


def cycles(quotient_bits: int) -> int:
    """Return the cycles from `start` to `done`."""
    return quotient_bits + 1
