# SPDX-License-Identifier: Apache-2.0
"""Frames per second of each depth format on a serial line."""

from __future__ import annotations

from typing import Final, NamedTuple

from tactile_depth.chip.link.depth_formats import VALUES_A_PACKET, DepthFormat, sent_shape, value_bytes
from tactile_depth.chip.link.framing import most_on_line
from tactile_depth.chip.link.packets import DEPTH_HEADER, TRAILER

BITS_A_BYTE: Final = 10  # on a serial line, with start and stop bit


class Rate(NamedTuple):
    """Depth frames on a serial line whose codes are the worst for COBS.

    Attributes
    ----------
    line_bytes : int
        Bytes of a frame on the line, with its trailer.
    frames_a_second : float
    value_bytes : int
        Bytes of a frame that are depth values.
    """

    line_bytes: int
    frames_a_second: float
    value_bytes: int

    @property
    def share(self) -> float:
        """Part of the line's bytes that are depth values."""
        return self.value_bytes / self.line_bytes


def rate(rows: int, columns: int, depth_format: DepthFormat, width: int = 24, baud: int = 3_000_000) -> Rate:
    """Return the rate at which depth frames of a grid fill a serial line of `baud` bits a second.

    Without replies and records; those take at most `most_on_line` of their bytes each.
    """
    sent_rows, sent_columns = sent_shape(depth_format, rows, columns)
    count, size = sent_rows * sent_columns, value_bytes(depth_format, width)
    header, trailer = DEPTH_HEADER.size, TRAILER.size
    packets, rest = divmod(count, VALUES_A_PACKET)
    line = packets * most_on_line(header + VALUES_A_PACKET * size) + most_on_line(trailer)
    line += most_on_line(header + rest * size) if rest else 0
    return Rate(line, baud / BITS_A_BYTE / line, count * size)
