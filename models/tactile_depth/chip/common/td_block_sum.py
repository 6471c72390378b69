# SPDX-License-Identifier: Apache-2.0
"""Model of hdl/common/td_block_sum.sv, frame by frame."""

from __future__ import annotations

from collections import deque
from typing import Any

import numpy as np

from tactile_depth.chip.fixed_point import joined, split

CYCLES_TO_SUM = 5
"""Cycles from the last word of a block's row to the write of its sum."""


def block_sum(frames: np.ndarray, block_log2: int, column_log2: int | None = None) -> np.ndarray:
    """Return the sum of each whole block of 2**block_log2 rows by 2**column_log2 words, by default as many.

    Parameters
    ----------
    frames : int array (frames, rows, columns, ...)

    Returns
    -------
    int array (frames, block rows, block columns, ...)
    """
    count, rows, columns, *channels = frames.shape
    block = 1 << block_log2
    wide = block if column_log2 is None else 1 << column_log2
    whole = frames[:, : rows // block * block, : columns // wide * wide]
    return whole.reshape(count, rows // block, block, columns // wide, wide, *channels).sum(axis=(2, 4))


class BlockSum:
    """Sums, added to what a memory answers.

    Attributes
    ----------
    place, size : int
        Words that came of the frame; words of a frame.
    """

    def __init__(self, **numbers: int) -> None:
        self._of, self._log2 = numbers, numbers["BlockLog2"]
        self._blocks = numbers["Rows"] >> self._log2, numbers["Columns"] >> numbers["ColumnLog2"]
        self.size, self.place = numbers["Rows"] * numbers["Columns"], 0
        self._sums: list[int] = []
        self._late: deque[Any] = deque([None] * CYCLES_TO_SUM)  # of rows of blocks: block, sums, begins, complete

    def _take(self, data: int) -> Any:
        """Add a word; return the row of a block that it ends."""
        of, (row, column) = self._of, divmod(self.place, self._of["Columns"])
        wide, high = (1 << of["ColumnLog2"]) - 1, (1 << self._log2) - 1
        sign = of["Signed"] << of["Width"] - 1
        words = [(word ^ sign) - sign for word in split(data, of["Channels"], of["Width"])]
        self._sums = [sum(pair) for pair in zip(self._sums, words, strict=True)] if column & wide else words
        if column & wide != wide or row >> self._log2 == self._blocks[0]:
            return None
        block = (row >> self._log2) * self._blocks[1] + (column >> of["ColumnLog2"])
        return [block, self._sums, self._first and row & high == 0, self._last and row & high == high]

    def clock(self, **pins: int) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        written, width = self._late.popleft(), self._of["SumWidth"]
        _, answered, read, _ = self._late
        out: dict[str, int | None] = {"read_en": 0, "write_en": written is not None, "write_complete": 0}
        if read is not None and not read[2]:
            out |= {"read_en": 1, "read_block": read[0]}
        if answered is not None and not answered[2]:
            before = split(pins["read_sums"], self._of["Channels"], width)
            answered[1] = [sum(pair) for pair in zip(answered[1], before, strict=True)]
        if written is not None:
            block, sums, _, complete = written
            out |= {"write_block": block, "write_sums": joined(sums, width), "write_complete": complete}
        self._late.append(None)
        if pins["in_valid"]:
            if pins["in_frame_start"]:
                self.place, self._first, self._last = 0, pins["in_first_frame"], pins["in_last_frame"]
            self._late[-1] = self._take(pins["in_data"])
            self.place = (self.place + 1) % self.size
        if pins["rst"]:
            self.place, self._late = 0, deque([None] * CYCLES_TO_SUM)
        return out
