# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/contact/record_packets.sv."""

from __future__ import annotations

from collections import deque

from tactile_depth.chip.fixed_point import split


class RecordPackets:
    """State of the packet sender between two clock edges.

    Attributes
    ----------
    sending : deque of int
        Remaining words of the current packet; the first one is offered.
    waiting : bool
        True if the record waits for the current packet to end.
    record, new : int, bool
        The newest record; whether it came in the cycle before.
    """

    def __init__(self, words: int) -> None:
        self.words, self.sending = words, deque[int]()
        self.waiting, self.record, self.new = False, 0, False

    def clock(self, *, rst: int, new_valid: int, new_record: int, m_event_tready: int) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        sending = self.sending
        out: dict[str, int | None] = {"record_valid": self.new, "record": self.record, "m_event_tvalid": bool(sending)}
        if sending:
            out |= {"m_event_tdata": sending[0], "m_event_tlast": len(sending) == 1}
            if m_event_tready:
                sending.popleft()
        if self.waiting and not sending:
            sending.extend(split(self.record, self.words, 32))
            self.waiting = False
        out["record_lost"] = new_valid and self.waiting
        self.new = bool(new_valid)
        if new_valid:
            self.record, self.waiting = new_record, True
        if rst:
            sending.clear()
            self.waiting, self.record, self.new = False, 0, False
        return out
