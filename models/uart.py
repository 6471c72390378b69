# SPDX-License-Identifier: Apache-2.0
"""Model of boards/ulx3s/uart_receive.sv and uart_transmit.sv: bytes from levels of a line, and levels from bytes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

BITS = 10  # a start bit (low), eight of data, lowest first, a stop bit (high)


def transmit(data: Iterable[int]) -> list[int]:
    """Levels of the line, one a bit."""
    return [level for byte in data for level in (0, *(byte >> place & 1 for place in range(BITS - 2)), 1)]


def receive(levels: Sequence[int], divider: int) -> list[int | None]:
    """Bytes of a line that begins in a reset.

    Parameters
    ----------
    levels : sequence of int
        Of the line, one a clock.
    divider : int
        Clocks a bit.

    Returns
    -------
    list of int or None
        None: a byte whose stop bit is low. One that the line ends in is left out.
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
