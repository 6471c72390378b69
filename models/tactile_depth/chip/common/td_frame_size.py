# SPDX-License-Identifier: Apache-2.0
"""Model of hdl/common/td_frame_size.sv: columns and rows that arrived last."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass
class FrameSize:
    """State of the core.

    Attributes
    ----------
    count_width, words_per_pixel : int
    columns, rows : int
        Pixels of the last row that ended, and rows of the last frame.
    words, ended : int
        Words of the row that arrives; rows that ended in the frame that arrives.
    framed, silent : bool
        A frame has begun since the reset; no word has come since the reset.
    """

    count_width: int = 14
    words_per_pixel: int = 1
    columns: int = 0
    rows: int = 0
    words: int = 0
    ended: int = 0
    framed: bool = False
    silent: bool = True

    def take(self, last: int, user: int) -> None:
        """Take a word."""
        most = 1 << self.count_width - 1
        if user:
            self.rows, self.ended, self.framed = min(self.ended, most), 0, True
        else:
            self.ended += last and self.framed
        self.words, self.silent = self.words + 1, False
        if last:
            self.columns, self.words = min(self.words // self.words_per_pixel, most), 0

    def clock(self, *, rst: int, in_valid: int, in_last: int, in_user: int) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it."""
        out = {"columns": self.columns, "rows": self.rows, "silent": int(self.silent)}
        if in_valid:
            self.take(in_last, in_user)
        if rst:
            self.columns = self.rows = self.words = self.ended = 0
            self.framed, self.silent = False, True
        return out
