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

    def choose(self, valid: Sequence[int]) -> int | None:
        """Return the source whose packet begins, of those that offer one; None if none does."""
        if valid[RECORD] and valid[DEPTH] and self.depth_is_next and not any(valid[:RECORD]):
            return DEPTH
        return next((source for source, offered in enumerate(valid) if offered), None)

    def clock(self, *, rst: int, out_ready: int, **pins: int) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it, but those that do not count."""
        valid, data, last = ([pins[f"{name}_{pin}"] for name in SOURCES] for pin in ("valid", "data", "last"))
        chosen = self.chosen
        out = {f"{name}_ready": 0 for name in SOURCES} | {"out_valid": 0}
        if chosen is None:
            self.chosen = self.choose(valid)
            if self.chosen in (RECORD, DEPTH):
                self.depth_is_next = self.chosen == RECORD
        else:
            out |= {f"{SOURCES[chosen]}_ready": out_ready, "out_valid": valid[chosen]}
            if valid[chosen]:
                out |= {"out_data": data[chosen], "out_last": last[chosen]}
            if valid[chosen] and last[chosen] and out_ready:
                self.chosen = None
        if rst:
            self.chosen, self.depth_is_next = None, False
        return out
