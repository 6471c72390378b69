# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/axis_skid.sv: a queue of two words."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

CAPACITY = 2


@dataclass
class AxisSkid:
    """The slice between two clock edges.

    Attributes
    ----------
    words : deque of int
        What it holds, oldest first.
    starting : bool
        In reset, and in the clock after it: nothing is taken yet.
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
        """One edge: `word` is offered on the input (None: no word); the output is `taken` if it is valid."""
        offered = word if self.ready else None
        if taken and self.words:
            self.words.popleft()
        if offered is not None:
            self.words.append(offered)
        self.starting = False

    def reset(self) -> None:
        """One edge in reset."""
        self.words.clear()
        self.starting = True
