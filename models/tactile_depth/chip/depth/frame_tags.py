# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/depth/frame_tags.sv: tags return a fixed number of enabled cycles after the push."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass
class FrameTags:
    """Tags held between two clock edges, by the enabled cycle in which each is due."""

    latency: int
    now: int = 0
    due_clock: dict[int, int] = field(default_factory=dict)

    @property
    def due(self) -> int | None:
        """Tag that is due in this cycle; None without one."""
        return self.due_clock.get(self.now)

    @property
    def held(self) -> bool:
        return bool(self.due_clock)

    def clock(self, pushed: int | None) -> None:
        """Advance by one clock edge with en set; `pushed` is the new tag, None without one."""
        self.due_clock.pop(self.now, None)
        if pushed is not None:
            self.due_clock[self.now + self.latency] = pushed
        self.now += 1

    def reset(self) -> None:
        """Advance by one clock edge in reset."""
        self.due_clock.clear()
