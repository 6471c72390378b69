# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/burst_counter.sv."""

from __future__ import annotations

from collections.abc import Iterable


def burst_counter(starts: Iterable[bool], size: int) -> list[int | None]:
    """Position of the word in each clock, None where there is none; a start in a burst begins again at 0."""
    positions: list[int | None] = []
    position: int | None = None
    for start in starts:
        running = position is not None and position < size - 1
        position = 0 if start else position + 1 if running and position is not None else None
        positions.append(position)
    return positions
