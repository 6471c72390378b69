# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/common/td_burst_counter.sv."""

from __future__ import annotations

from collections.abc import Iterable


def burst_counter(starts: Iterable[bool], size: int) -> list[int | None]:
    """Return the position of the word in each cycle, None without a word; a start within a burst restarts at 0."""
    positions: list[int | None] = []
    position: int | None = None
    for start in starts:
        running = position is not None and position < size - 1
        position = 0 if start else position + 1 if running and position is not None else None
        positions.append(position)
    return positions
