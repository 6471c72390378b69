# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/frame_tags.sv: a queue of four tags."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

CAPACITY = 4


@dataclass
class FrameTags:
    """The tags held between two clock edges, oldest first."""

    tags: deque[int] = field(default_factory=deque)

    @property
    def head(self) -> int | None:
        """The oldest tag; None: there is none, and the output says nothing."""
        return self.tags[0] if self.tags else None

    def clock(self, pushed: int | None, pop: bool) -> None:
        """One edge; None: nothing is pushed.

        Raises
        ------
        IndexError
            Popped while empty, or pushed while full.
        """
        if pop:
            self.tags.popleft()
        if pushed is not None:
            if len(self.tags) == CAPACITY:
                raise IndexError(f"a fifth tag: it holds {CAPACITY}")
            self.tags.append(pushed)

    def reset(self) -> None:
        """One edge in reset."""
        self.tags.clear()
