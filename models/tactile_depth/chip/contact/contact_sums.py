# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/contact/contact_sums.sv: area, limits, weight and moments of what is above a threshold."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from tactile_depth.chip.contact import beat_sums
from tactile_depth.chip.contact.beats import marked
from tactile_depth.chip.fixed_point import codes


def cycles_to_sums(lanes: int = 1) -> int:
    """Return the cycles from the last depths of a frame to its sums."""
    return 2 + beat_sums.latency(lanes)


class Sums(NamedTuple):
    """Depths above the threshold in a frame. Positions are (row, column), with rows counted from the top.

    The weight of a depth is what it is above the threshold. Moments count from the last row to come and from the last
    column.
    """

    area: int = 0
    least: tuple[int, int] = (0, 0)
    greatest: tuple[int, int] = (0, 0)
    weight: int = 0
    row_moment: int = 0
    column_moment: int = 0


@dataclass
class ContactSums:
    """State between two depths that leave.

    Attributes
    ----------
    threshold : int
        Of the current frame; None before the first frame.
    codes : list of int
        Depths of the frame so far.
    """

    rows: int
    columns: int
    bottom_first: bool = False
    threshold: int | None = None
    codes: list[int] = field(default_factory=list)

    def beat(self, data: int, frame_start: bool, frame_end: bool, threshold: int) -> Sums | None:
        """Take a depth code that leaves; return the sums of the frame with its last code, else None.

        The threshold is taken with the first.

        Raises
        ------
        ValueError
            No frame has begun.
        """
        if frame_start:
            self.threshold, self.codes = threshold, []
        if self.threshold is None:
            raise ValueError("a depth code left before the first of any frame")
        self.codes.append(data)
        if not frame_end:
            return None
        return self.whole_frame(np.array(self.codes, np.int64).reshape(self.rows, self.columns), self.threshold)

    def whole_frame(self, depths: np.ndarray, threshold: int) -> Sums:
        """Return the sums of a frame whose depth codes leave one after another, as `beat` makes them.

        Parameters
        ----------
        depths : int array (rows, columns)
            In the order in which rows leave.
        """
        self.threshold = threshold
        rows, columns = np.nonzero(depths > threshold)
        if not rows.size:
            return Sums()
        weights = depths[rows, columns].astype(np.int64) - threshold
        upright = self.rows - 1 - rows if self.bottom_first else rows
        return Sums(
            rows.size,
            (int(upright.min()), int(columns.min())),
            (int(upright.max()), int(columns.max())),
            int(weights.sum()),
            int((weights * (self.rows - 1 - rows)).sum()),
            int((weights * (self.columns - 1 - columns)).sum()),
        )


class SumsByClock:
    """ContactSums of beats, and sums on their way."""

    def __init__(self, width: int, rows: int, columns: int, lanes: int, bottom_first: int) -> None:
        self.width, self.lanes, self.sums = width, lanes, ContactSums(rows, columns, bool(bottom_first))
        self._late: deque[Sums | None] = deque([None] * cycles_to_sums(lanes))
        self._numbers = ""  # of the last frame, as bits

    def clock(
        self, *, rst: int, in_valid: int, in_position: int, in_data: int, threshold: int
    ) -> dict[str, int | str | None]:
        """Advance by one clock edge; return the outputs before it. Limits have no meaning without area."""
        sums, ended = self._late.popleft(), None
        out: dict[str, int | str | None] = {"sums_valid": sums is not None}
        limits = ""
        if sums is not None:
            self._numbers = f"{sums.area:032b}{sums.weight:064b}{sums.row_moment:064b}{sums.column_moment:064b}"
            limits = "".join(f"{place:016b}" for place in (*sums.greatest, *sums.least)) * bool(sums.area)
        out["sums"] = self._numbers + limits
        if in_valid:
            for depth, start, _, end in marked(in_data, in_position, self.lanes, self.width):
                ended = self.sums.beat(depth, start, end, *codes(threshold, 1, self.width))
        self._late.append(ended)
        if rst:
            self._late, self._numbers = deque([None] * len(self._late)), ""
        return out
