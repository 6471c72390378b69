# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/contact/contact_peak.sv: count and peak of what is above the threshold."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from tactile_depth.chip.contact import beat_peak

CYCLES_TO_COUNT = 2  # from the last depth of a frame


def cycles_to_peak(lanes: int = 1) -> int:
    """Return the cycles from the last depths of a frame to its peak."""
    return CYCLES_TO_COUNT + beat_peak.latency(lanes) + 1


class Peak(NamedTuple):
    """Depths above the threshold in a frame. The position is (row, column), with rows counted from the top."""

    above: int = 0  # depths
    peak: int = 0
    position: tuple[int, int] = (0, 0)  # of equal peaks the first in the order of the stream


@dataclass
class ContactPeak:
    """State between two depths that leave.

    Attributes
    ----------
    found
        Of the current frame so far; None before the first frame.
    """

    rows: int
    columns: int
    bottom_first: bool = False
    row: int = 0
    column: int = 0
    found: Peak | None = None

    def beat(self, data: int, frame_start: bool, row_end: bool, frame_end: bool, threshold: int) -> Peak | None:
        """Take a depth code that leaves; return the peak of the frame with its last code, else None.

        Raises
        ------
        ValueError
            No frame has begun.
        """
        if frame_start:
            self.found = Peak()
            self.row, self.column = (self.rows - 1 if self.bottom_first else 0), 0
        if self.found is None:
            raise ValueError("a depth code left before the first of any frame")
        if data > threshold:
            count, peak, _ = self.found
            higher = not count or data > peak
            self.found = Peak(count + 1, data, (self.row, self.column)) if higher else Peak(count + 1, *self.found[1:])
        self.column += 1
        if row_end:
            self.row, self.column = self.row + (-1 if self.bottom_first else 1), 0
        return self.found if frame_end else None

    def whole_frame(self, depths: np.ndarray, threshold: int) -> Peak:
        """Return the peak of a frame whose depth codes leave one after another, as `beat` finds it.

        Parameters
        ----------
        depths : int array (rows, columns)
            In the order in which rows leave.
        """
        count = int(np.count_nonzero(depths > threshold))
        row, column = divmod(int(depths.argmax()), self.columns)  # the first of equal peaks
        position = self.rows - 1 - row if self.bottom_first else row, column
        self.found = Peak(count, int(depths.max()), position) if count else Peak()
        return self.found
