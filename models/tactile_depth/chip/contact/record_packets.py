# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/contact/record_packets.sv."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field


@dataclass
class RecordPackets:
    """State of the packet sender between two clock edges.

    Attributes
    ----------
    sending : deque of int
        Remaining words of the current packet; the first one is offered.
    waiting : tuple of int or None
        Words of a record that waits for the current packet to end.
    """

    sending: deque[int] = field(default_factory=deque)
    waiting: tuple[int, ...] | None = None

    def clock(self, renewed: tuple[int, ...] | None, ready: bool) -> bool:
        """Advance by one clock edge; return True if a record is lost.

        `renewed` holds the words of a new record (None: no new record); `ready` is set if the sink takes a word.
        """
        leaves = bool(self.sending) and ready
        send = self.waiting is not None and len(self.sending) <= leaves
        lost = renewed is not None and self.waiting is not None and not send
        if leaves:
            self.sending.popleft()
        if send and self.waiting is not None:
            self.sending.extend(self.waiting)
            self.waiting = None
        if renewed is not None:
            self.waiting = renewed
        return lost

    def reset(self) -> None:
        """Advance by one clock edge in reset."""
        self.sending.clear()
        self.waiting = None
