# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/common/td_hold_check.sv: whether a word that waits has a flipped bit."""

from __future__ import annotations


class HoldCheck:
    """State between two clocks.

    Attributes
    ----------
    is_new : bool
        `word` is new in this clock.
    held : int or None
        The word as it was new, None if none came since a reset.
    """

    def __init__(self) -> None:
        self.is_new = False
        self.held: int | None = None
        self._flipped = False

    def clock(self, *, rst: int, comes: int, word: int) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it."""
        out = {"flipped": int(self._flipped)}
        if self.is_new:
            self.held = word
        self._flipped = self.held is not None and (word ^ self.held).bit_count() % 2 == 1
        if rst:
            self.held, self._flipped = None, False
        self.is_new = bool(comes)
        return out
