# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/common/td_axis_skid.sv: a queue of two words."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

LATENCY = 1

CAPACITY = 2


@dataclass
class AxisSkid:
    """State of the skid buffer between two clock edges.

    Attributes
    ----------
    words : deque of int
        Words in the queue, oldest first.
    starting : bool
        True in reset and in the cycle after it, when nothing is taken.
    """

    words: deque[int] = field(default_factory=deque)
    starting: bool = True

    def clock(self, *, rst: int, s_valid: int, s_data: int, m_ready: int) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        words, ready = self.words, not self.starting and len(self.words) < CAPACITY
        out = {"s_ready": ready, "m_valid": bool(words), "m_data": words[0] if words else None}
        if m_ready and words:
            words.popleft()
        if s_valid and ready:
            words.append(s_data)
        self.starting = bool(rst)
        if rst:
            words.clear()
        return out
