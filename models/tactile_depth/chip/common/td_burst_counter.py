# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/common/td_burst_counter.sv."""

from __future__ import annotations


class BurstCounter:
    """Position of the next word of a burst of `words`, None behind the last one."""

    def __init__(self, words: int) -> None:
        self.words = words
        self.next: int | None = None

    def clock(self, *, rst: int, en: int, start: int) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        position = 0 if start else self.next
        if en:
            self.next = None if position in (None, self.words - 1) else position + 1
        if rst:
            self.next = None
        return {"position": position, "active": position is not None}
