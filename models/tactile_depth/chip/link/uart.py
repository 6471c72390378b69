# SPDX-License-Identifier: Apache-2.0
"""Models of hdl/link/uart_receive.sv, bytes from levels of a line, and uart_transmit.sv, levels from bytes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

BITS = 10  # a start bit (low), eight data bits (lowest first), a stop bit (high)


def transmit(data: Iterable[int]) -> list[int]:
    """Return the levels of the line, one for each bit."""
    return [level for byte in data for level in (0, *(byte >> place & 1 for place in range(BITS - 2)), 1)]


def receive(levels: Sequence[int], divider: int) -> list[int | None]:
    """Return the bytes on a line that begins in a reset.

    Parameters
    ----------
    levels : sequence of int
        Levels of the line, one for each cycle.
    divider : int
        Cycles for each bit.

    Returns
    -------
    list of int or None
        None stands for a byte whose stop bit is low. A byte that is incomplete at the end of the line is left out.
    """
    found: list[int | None] = []
    clock, silent = 0, True
    while clock < len(levels):
        if levels[clock] or silent:
            silent = silent and not levels[clock]
            clock += 1
            continue
        samples = levels[clock + divider // 2 :: divider][:BITS]
        if samples and samples[0]:  # no start bit
            clock += divider // 2 + 1
            continue
        if len(samples) < BITS:
            break
        silent = not samples[-1]
        found.append(None if silent else sum(level << place for place, level in enumerate(samples[1:-1])))
        clock += divider // 2 + (BITS - 1) * divider + 1
    return found
