# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/link/packet_store.sv."""

from __future__ import annotations

from collections import deque
from typing import Final, NamedTuple

BANKS: Final = 2


class Offer(NamedTuple):
    """Byte that the store offers.

    Attributes
    ----------
    byte : int
    last : bool
        It is the last one that was kept of its packet.
    length : int
        True length of the packet.
    """

    byte: int
    last: bool
    length: int


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
    """

    def __init__(self, bank_bytes: int) -> None:
        self._bank_bytes = bank_bytes
        self.reset()

    def reset(self) -> None:
        """Advance by one clock edge in reset."""
        self.bad = False
        self._packet = bytearray()  # that is written
        self._lost = False
        self._waiting: deque[bytes] = deque()
        self._place = 0  # of the next byte of the first that waits
        self._reads = self._offers = False  # a byte is read; one is offered

    @property
    def ready(self) -> bool:
        """A bank is free."""
        return len(self._waiting) < BANKS

    @property
    def offer(self) -> Offer | None:
        """Byte that is offered, None if none is."""
        if not self._offers:
            return None
        packet = self._waiting[0]
        last = self._place + 1 == min(len(packet), self._bank_bytes)
        return Offer(packet[self._place], last, len(packet))

    def clock(self, data: int | None, ends: bool, good: bool, ready: bool, drop: bool) -> None:
        """Advance by one clock edge.

        `data` is the byte that came, None for none; `ends` and `good` are of its packet. `ready` and `drop` are of the
        consumer: it takes a byte, and wants no other byte of the packet.
        """
        offer, has_room = self.offer, self.ready
        waits = bool(self._waiting)
        if offer is not None and ready:
            self._place += 1
            if offer.last or drop:
                self._place = 0
                self._waiting.popleft()
        self._reads, self._offers = (
            waits and not self._reads and offer is None,
            self._reads if offer is None else not ready,
        )
        self.bad = ends and not (good and not self._lost)
        if data is not None:
            self._packet.append(data)
            self._lost |= not has_room
        if ends:
            if not self.bad:
                self._waiting.append(bytes(self._packet))
            self._packet.clear()
            self._lost = False
