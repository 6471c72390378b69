# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/contact/contact_peak.sv: count and peak of what is above the threshold."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from tactile_depth.chip.contact import beat_peak
from tactile_depth.chip.contact.beats import marked
from tactile_depth.chip.fixed_point import codes

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


class PeakByClock:
    """ContactPeak of beats, and peaks on their way."""

    def __init__(self, width: int, rows: int, columns: int, lanes: int, bottom_first: int) -> None:
        self.width, self.lanes, self.peak = width, lanes, ContactPeak(rows, columns, bool(bottom_first))
        self._clear()

    def _clear(self) -> None:
        self._late: deque[Peak | None] = deque([None] * (cycles_to_peak(self.lanes) - 1))
        self._beat: Any = None  # of the clock before: depths, position, which are above, threshold

    def _judged(self, touching: int, data: int, position: int, above: int, off: int) -> Peak | None:
        """Take the beat of the clock before; `touching` is read now."""
        for lane, beat in enumerate(marked(data, position, self.lanes, self.width)):
            peak = self.peak.beat(*beat, off if touching else beat[0] - (above >> lane & 1))
        return peak

    def clock(
        self,
        *,
        rst: int,
        in_valid: int,
        in_position: int,
        in_data: int,
        in_above: int,
        off_threshold: int,
        touching: int,
    ) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        peak, counted = self._late.popleft(), self._late[-1]
        out: dict[str, int | None] = {"count_valid": counted is not None, "peak_valid": peak is not None}
        if counted is not None:
            out["count"] = counted.above
        if peak is not None:
            row, column = peak.position
            out |= {"any_above": bool(peak.above), "peak": peak.peak, "peak_row": row, "peak_column": column}
        self._late.append(self._judged(touching, *self._beat) if self._beat else None)
        (off,) = codes(off_threshold, 1, self.width + 1)
        self._beat = (in_data, in_position, in_above, off) if in_valid else None
        if rst:
            self._clear()
        return out
