# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/depth/frame_tags.sv: tags return a fixed number of enabled cycles after the push."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass
class Tag:
    """A tag, the enabled cycle in which it is due, its late part, None until that comes, and whether it was marked."""

    word: int
    due: int
    marked: bool
    part: int | None = None


@dataclass
class FrameTags:
    """Tags held between two clock edges, by the enabled cycle in which each is due; those pushed and due last."""

    latency: int
    keep: int
    now: int = 0
    due_clock: dict[int, Tag] = field(default_factory=dict)
    pushed: Tag | None = None
    last: Tag | None = None

    def clock(
        self, *, rst: int, en: int, push: int, tag: int, marked: int, late: int, late_part: int, mark: int
    ) -> dict[str, int | bool | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        due, kept = (
            self.due_clock.get(self.now),
            self.last if self.last and self.now <= self.last.due + self.keep else None,
        )
        out: dict[str, int | bool | None] = {"due": due is not None, "held": bool(self.due_clock)}
        out["due_tag"] = due.word if due else None
        out |= {"late_tag": kept.part, "late_marked": kept.marked} if kept else {}
        for each in (*self.due_clock.values(), *([self.last] if self.last else [])):
            each.marked |= bool(mark)
        if en:
            if due is not None:
                del self.due_clock[self.now]
                self.last = due
            if late and self.pushed:
                self.pushed.part = late_part
            if push:
                self.pushed = self.due_clock[self.now + self.latency] = Tag(
                    tag, self.now + self.latency, bool(marked or mark)
                )
            self.now += 1
        if rst:
            self.due_clock.clear()
            self.pushed = self.last = None
        return out
