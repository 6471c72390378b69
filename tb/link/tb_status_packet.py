# SPDX-License-Identifier: Apache-2.0
"""status_packet in every clock."""

from typing import Any

import cocotb

from formal.entries import FULL_WIDTH, Proof
from tactile_depth.chip.link.packets import STATUS, VERSION, Kind
from tb.lockstep import WORD, play
from tb.structures import BOTH, ICARUS, Structure

STRUCTURES = (Structure(on=BOTH, mutants=ICARUS),)
PROTOCOL = {"counts": "live & ~reset", "status_data status_last": "counts & status_valid"}
PROOFS = (Proof(FULL_WIDTH, steps=2),)
FIELDS = STATUS.size - 2  # bytes behind kind and version


class StatusPacket:
    """A packet is due behind each reset and each request; the rest of the one that has begun is `left`."""

    due, was_reset, left = 0, 1, b""

    def clock(self, *, rst: int, request: int, fields: int, status_ready: int) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it, but those that do not count."""
        packet = self.left or (bytes((Kind.STATUS, VERSION)) + fields.to_bytes(FIELDS, "little") if self.due else b"")
        begins = packet and not self.left and status_ready
        self.due = request or self.was_reset or (self.due and not begins)
        self.left = packet[1:] if status_ready else self.left
        if rst:
            self.due, self.left = 0, b""
        self.was_reset = rst
        if not packet:
            return {"status_valid": 0}
        return {"status_valid": 1, "status_data": packet[0], "status_last": len(packet) == 1}


@cocotb.test
async def packets(dut: Any) -> None:
    await play(dut, StatusPacket(), {"request": 0.1, "fields": WORD, "status_ready": 1.0})
