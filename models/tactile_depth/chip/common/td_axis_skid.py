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

    @property
    def ready(self) -> bool:
        return not self.starting and len(self.words) < CAPACITY

    @property
    def valid(self) -> bool:
        return bool(self.words)

    def clock(self, word: int | None, taken: bool) -> None:
        """Advance by one clock edge.

        `word` is offered on the input (None: no word); the sink takes the output if it is valid and `taken` is set.
        """
        offered = word if self.ready else None
        if taken and self.words:
            self.words.popleft()
        if offered is not None:
            self.words.append(offered)
        self.starting = False

    def reset(self) -> None:
        """Advance by one clock edge in reset."""
        self.words.clear()
        self.starting = True
