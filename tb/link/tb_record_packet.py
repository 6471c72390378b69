# SPDX-License-Identifier: Apache-2.0
"""record_packet in every clock, against packets.RecordPacket."""

from typing import Any

import cocotb

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.contact.contact_events import WORDS, record
from tactile_depth.chip.link.packets import RecordPacket
from tb.lockstep import WORD, Pins, play
from tb.structures import BOTH, ICARUS, Mutants, Structure

STRUCTURES = (Structure(on=BOTH, mutants=ICARUS),)
MUTANTS = Mutants(flat=False)
PROOFS = (Proof(f"the size in use; one bit of an arbitrary word is followed: {WORD_FREE}"),)


BANK_CLOCKS = 2  # from the last byte of a word to the next word


class Packets:
    """The record that comes, the newest whole one, and the rest of the packet that leaves."""

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        self.words: list[int] = []
        self.newest: list[int] = []
        self.packet = b""
        self.wait = 0  # clocks to the next word

    def clock(
        self, *, rst: int, s_event_tvalid: int, s_event_tdata: int, s_event_tlast: int, record_ready: int
    ) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it, but those that do not count."""
        packet = self.packet or (RecordPacket(record(self.newest)).pack() if self.newest else b"")
        out: dict[str, int] = {"record_valid": bool(packet) and not self.wait}
        self.wait = max(self.wait - 1, 0)
        if out["record_valid"]:
            out |= {"record_data": packet[0], "record_last": len(packet) == 1}
            if record_ready:
                self.newest = self.newest if self.packet else []
                self.packet = packet[1:]
                self.wait = 0 if len(self.packet) % 4 else BANK_CLOCKS * bool(self.packet)
        if s_event_tvalid:
            if not self.words and self.packet:  # both banks are in use
                self.newest = []
            self.words.append(s_event_tdata)
            if s_event_tlast:
                self.newest, self.words = self.words, []
        if rst:
            self.reset()
        return out


def legal(model: Packets, pins: Pins) -> None:
    """End a record with its last word."""
    if pins["s_event_tvalid"]:
        pins["s_event_tlast"] = len(model.words) == WORDS - 1


@cocotb.test
async def packets(dut: Any) -> None:
    choices = {"s_event_tvalid": 1.0, "s_event_tdata": WORD, "s_event_tlast": 1.0, "record_ready": 1.0}
    await play(dut, Packets(), choices, legal)
