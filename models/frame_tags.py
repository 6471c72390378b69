# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/frame_tags.sv: tags come back a fixed number of clocks after they were pushed."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass
class FrameTags:
    """The tags held between two clock edges, by the enabled clock in which each is due."""

    latency: int
    now: int = 0
    due_clock: dict[int, int] = field(default_factory=dict)

    @property
    def due(self) -> int | None:
        """The tag that is due in this clock; None: there is none."""
        return self.due_clock.get(self.now)

    @property
    def held(self) -> bool:
        return bool(self.due_clock)

    def clock(self, pushed: int | None) -> None:
        """One edge with en; None: nothing is pushed."""
        self.due_clock.pop(self.now, None)
        if pushed is not None:
            self.due_clock[self.now + self.latency] = pushed
        self.now += 1

    def reset(self) -> None:
        """One edge in reset."""
        self.due_clock.clear()
