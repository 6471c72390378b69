# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/depth/frame_output.sv."""

from __future__ import annotations


class FrameOutput:
    """Place in a frame.

    Attributes
    ----------
    place : int
        Place of the next word in its frame; behind the last one until a frame is due.
    bad : bool
        The frame does not leave.
    """

    def __init__(self, rows: int, columns: int) -> None:
        self.columns, self.size = columns, rows * columns
        self.place, self.bad = self.size, False

    def clock(
        self, *, rst: int, en: int, in_start: int, in_frame_start: int, in_data: int, in_due: int, in_bad: int
    ) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        place, bad = (0, in_bad or not in_frame_start) if in_due else (self.place, self.bad)
        active, column = place < self.size, place % self.columns
        row_end, frame_end = column == self.columns - 1, place == self.size - 1
        valid = active and not bad
        if rst:
            self.place = self.size
        elif en:
            self.place, self.bad = place + active, bool(bad)
        return {
            "active": active,
            "out_of_step": in_start != (active and column == 0) or in_frame_start != in_due,
            "out_valid": valid,
            "out_position": active and in_due << 2 | row_end << 1 | frame_end,
            "out_data": in_data if valid else None,
        }
