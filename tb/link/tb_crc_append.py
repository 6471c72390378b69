# SPDX-License-Identifier: Apache-2.0
"""crc_append in every clock."""

import zlib
from typing import Any

import cocotb

from formal.entries import FULL_WIDTH, Proof
from tactile_depth.chip.link.framing import CRC_BYTES
from tb.lockstep import WORD, play
from tb.structures import BOTH, ICARUS, Mutants, Structure

STRUCTURES = (Structure(on=BOTH, mutants=ICARUS),)
MUTANTS = Mutants(repeats=2)
PROTOCOL = {"stays": "in_", "counts": "live & ~reset", "out_data out_last": "counts & out_valid"}
PROOFS = (Proof(FULL_WIDTH, steps=2),)


class CrcAppend:
    """The CRC of the packet so far, and the bytes of it that follow the packet."""

    crc, tail = 0, b""

    def clock(self, *, rst: int, in_valid: int, in_data: int, in_last: int, out_ready: int) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it, but those that do not count."""
        if self.tail:
            out = {"in_ready": 0, "out_valid": 1, "out_data": self.tail[0], "out_last": len(self.tail) == 1}
            self.tail = self.tail[out_ready:]
        else:
            out = {"in_ready": out_ready, "out_valid": in_valid}
            if in_valid:
                out |= {"out_data": in_data, "out_last": 0}
            if in_valid and out_ready:
                self.crc = zlib.crc32(bytes((in_data,)), self.crc)
            if in_valid and out_ready and in_last:
                self.crc, self.tail = 0, self.crc.to_bytes(CRC_BYTES, "little")
        if rst:
            self.crc, self.tail = 0, b""
        return out


@cocotb.test
async def packets(dut: Any) -> None:
    choices = {"in_valid": 1.0, "in_data": WORD, "in_last": 0.3, "out_ready": 1.0}
    await play(dut, CrcAppend(), choices, offers=["in"], clocks=4_000)  # a CRC is slow in Icarus
