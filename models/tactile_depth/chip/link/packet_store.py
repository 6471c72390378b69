# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/link/packet_store.sv."""

from __future__ import annotations

from collections import deque
from typing import Final

BANKS: Final = 2


class PacketStore:
    """State of the store between two clock edges.

    Parameters
    ----------
    bank_bytes : int
        Bytes that are kept of a packet.

    Attributes
    ----------
    bad : bool
        A packet was bad or lost, in the clock before.
    packet : bytearray
        Bytes that came of the packet that is written.
    """

    def __init__(self, bank_bytes: int) -> None:
        self._bank_bytes = bank_bytes
        self.reset()

    def reset(self) -> None:
        """Advance by one clock edge in reset."""
        self.bad = False
        self.packet = bytearray()
        self._lost = False
        self._waiting: deque[bytes] = deque()
        self._place = 0  # of the next byte of the first that waits
        self._reads = self._offers = False  # a byte is read; one is offered

    @property
    def ready(self) -> bool:
        """A bank is free."""
        return len(self._waiting) < BANKS

    def clock(
        self, *, rst: int, in_valid: int, in_data: int, in_end: int, in_good: int, out_ready: int, out_drop: int
    ) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it, but those that do not count."""
        out: dict[str, int] = {"in_ready": self.ready, "bad": self.bad, "out_valid": self._offers}
        waits, has_room = bool(self._waiting), self.ready
        if self._offers:
            packet = self._waiting[0]
            length, last = len(packet), self._place + 1 == min(len(packet), self._bank_bytes)
            out |= {"out_data": packet[self._place], "out_last": last}
            out |= {"out_length": length, "out_length_mod3": length % 3}
            if out_ready:
                self._place += 1
                if last or out_drop:
                    self._place = 0
                    self._waiting.popleft()
        self._reads, self._offers = (
            waits and not self._reads and not self._offers,
            self._reads or (self._offers and not out_ready),
        )
        self.bad = bool(in_end and (self._lost or not in_good))
        if in_valid:
            self.packet.append(in_data)
            self._lost |= not has_room
        if in_end:
            if not self.bad:
                self._waiting.append(bytes(self.packet))
            self.packet.clear()
            self._lost = False
        if rst:
            self.reset()
        return out
