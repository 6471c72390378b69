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

    def clock(self, *, rst: int, en: int, push: int, tag: int) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it."""
        due = self.due_clock.get(self.now)
        out = {"due": due is not None, "due_tag": due or 0, "held": bool(self.due_clock)}
        if en:
            self.due_clock.pop(self.now, None)
            if push:
                self.due_clock[self.now + self.latency] = tag
            self.now += 1
        if rst:
            self.due_clock.clear()
        return out
