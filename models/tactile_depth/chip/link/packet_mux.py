# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/link/packet_mux.sv."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

SOURCES: Final = ("status", "reply", "record", "depth")  # the first goes first
RECORD: Final = SOURCES.index("record")
DEPTH: Final = SOURCES.index("depth")


@dataclass
class PacketMux:
    """State between two clock edges.

    Attributes
    ----------
    chosen : int or None
        Source of the packet that passes.
    depth_is_next : bool
        A record was chosen after the last packet of depth.
    """

    chosen: int | None = None
    depth_is_next: bool = False

    def choose(self, valid: Sequence[bool]) -> int | None:
        """Return the source whose packet begins, of those that offer one; None if none does."""
        if valid[RECORD] and valid[DEPTH] and self.depth_is_next and not any(valid[:RECORD]):
            return DEPTH
        return next((source for source, offered in enumerate(valid) if offered), None)

    def clock(self, valid: Sequence[bool], last: Sequence[bool], ready: bool) -> None:
        """Advance by one clock edge, with valid and last of each source, and ready of the sink."""
        if self.chosen is None:
            self.chosen = self.choose(valid)
            if self.chosen in (RECORD, DEPTH):
                self.depth_is_next = self.chosen == RECORD
        elif valid[self.chosen] and last[self.chosen] and ready:
            self.chosen = None

    def reset(self) -> None:
        """Advance by one clock edge in reset."""
        self.chosen, self.depth_is_next = None, False
