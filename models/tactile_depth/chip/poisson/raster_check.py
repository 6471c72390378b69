# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/raster_check.sv: whether positions are those of whole frames in raster order."""

from __future__ import annotations

FIRST_ROW, FIRST_COLUMN, LAST_ROW, LAST_COLUMN = 1, 2, 4, 8
"""Bits of position_t in hdl/td_types_pkg.sv."""


def place(pixel: int, rows: int, columns: int) -> int:
    """Return the position of a pixel, numbered in raster order through its frame."""
    row, column = divmod(pixel, columns)
    first = FIRST_ROW * (row == 0) | FIRST_COLUMN * (column == 0)
    return first | LAST_ROW * (row == rows - 1) | LAST_COLUMN * (column == columns - 1)


class RasterCheck:
    """State between two clocks.

    Attributes
    ----------
    due : int
        Number of the pixel in its frame that comes next.
    """

    def __init__(self, rows: int, columns: int) -> None:
        self.rows, self.columns = rows, columns
        self._reset()

    def _reset(self) -> None:
        self.due, self._wrong = 0, False

    def clock(self, *, rst: int, en: int, in_valid: int, in_position: int) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it."""
        out = {"wrong": int(self._wrong)}
        taken = bool(en and in_valid)
        self._wrong = taken and in_position != place(self.due, self.rows, self.columns)
        if taken:
            starts = in_position & FIRST_ROW and in_position & FIRST_COLUMN
            self.due = (1 if starts else self.due + 1) % (self.rows * self.columns)
        if rst:
            self._reset()
        return out
