# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/contact/contact_sums.sv: area, sums, limits and peak of what is above the threshold."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from tactile_depth.contact import beat_sums

WORD_BITS = 32
CYCLES_TO_AREA = 2  # from the last depth of a frame


def cycles_to_sums(lanes: int = 1) -> int:
    """Return the cycles from the last depths of a frame to its sums."""
    return CYCLES_TO_AREA + beat_sums.latency(lanes) + 1


class Thresholds(NamedTuple):
    """Depth codes, as they stand at the first depth of a frame."""

    on: int
    off: int


class Sums(NamedTuple):
    """Depths above the threshold in a frame. Positions are (row, column), with rows counted from the top."""

    area: int = 0
    peak: int = 0
    peak_position: tuple[int, int] = (0, 0)
    least: tuple[int, int] = (0, 0)
    greatest: tuple[int, int] = (0, 0)
    column_sum: int = 0
    row_sum: int = 0
    volume: int = 0

    @property
    def words(self) -> tuple[int, ...]:
        """Words 4 to 11 of a record."""
        volume = self.volume % (1 << 2 * WORD_BITS)
        return (
            self.peak % (1 << WORD_BITS),
            *(row << 16 | column for row, column in (self.peak_position, self.least, self.greatest)),
            self.column_sum,
            self.row_sum,
            volume % (1 << WORD_BITS),
            volume >> WORD_BITS,
        )


def frame_sums(depths: np.ndarray, rows: np.ndarray, columns: np.ndarray) -> Sums:
    """Return the sums of depths above the threshold and of their positions, in the order of the stream."""
    if not len(depths):
        return Sums()
    first = int(depths.argmax())  # the first of equal peaks
    return Sums(
        len(depths),
        int(depths[first]),
        (int(rows[first]), int(columns[first])),
        (int(rows.min()), int(columns.min())),
        (int(rows.max()), int(columns.max())),
        int(columns.sum()),
        int(rows.sum()),
        int(depths.sum()),
    )


@dataclass
class ContactSums:
    """State between two depths that leave.

    Attributes
    ----------
    thresholds
        Of the current frame; None before the first frame.
    above
        Depth, row and column of those above the threshold so far.
    """

    rows: int
    columns: int
    bottom_first: bool = False
    thresholds: Thresholds | None = None
    row: int = 0
    column: int = 0
    above: list[tuple[int, int, int]] = field(default_factory=list)

    def beat(
        self, data: int, frame_start: bool, row_end: bool, frame_end: bool, thresholds: Thresholds, touching: bool
    ) -> Sums | None:
        """Take a depth code that leaves; return the sums of the frame with its last code, else None.

        Raises
        ------
        ValueError
            No frame has begun.
        """
        if frame_start:
            self.thresholds, self.above = thresholds, []
            self.row, self.column = (self.rows - 1 if self.bottom_first else 0), 0
        if self.thresholds is None:
            raise ValueError("a depth code left before the first of any frame")
        if data > (self.thresholds.off if touching else self.thresholds.on):
            self.above.append((data, self.row, self.column))
        self.column += 1
        if row_end:
            self.row, self.column = self.row + (-1 if self.bottom_first else 1), 0
        if not frame_end:
            return None
        return frame_sums(*np.array(self.above, np.int64).reshape(-1, 3).T)

    def whole_frame(self, depths: np.ndarray, thresholds: Thresholds, touching: bool) -> Sums:
        """Return the sums of a frame whose depth codes leave one after another, as `beat` makes them.

        Parameters
        ----------
        depths : int array (rows, columns)
            In the order in which rows leave.
        """
        self.thresholds = thresholds
        above = depths > (thresholds.off if touching else thresholds.on)
        rows, columns = np.nonzero(above)
        upright = self.rows - 1 - rows if self.bottom_first else rows
        return frame_sums(depths[above].astype(np.int64), upright, columns)
