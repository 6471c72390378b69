# SPDX-License-Identifier: Apache-2.0
"""packet_check against its model in every clock."""

import zlib
from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.link.framing import CRC_BYTES
from tactile_depth.chip.link.packet_check import PacketCheck
from tb.lockstep import WORD, Pins, play
from tb.structures import BOTH, Mutants, Structure

STRUCTURES = (Structure(on=BOTH, mutants=BOTH),)
PROTOCOL = {
    "holds": "~(in_valid & in_end)",
    "counts": "live",
    "out_data": "live & out_valid",
    "out_good": "live & out_end",
}
MUTANTS = Mutants()  # a CRC is slow in Icarus
PROOFS = (Proof("the widths in use"),)
AT_ONCE, GOOD = -2, -1  # kinds of packets; the others have this bit wrong
POLYNOMIAL = 0xEDB88320


def changed(bit: int) -> int:
    """Return the change of a CRC that changes one bit of the remainder behind it."""
    remainder = 1 << bit
    for _ in range(8 * CRC_BYTES):  # a step of the CRC, backwards
        top = remainder >> 31
        remainder = ((remainder ^ POLYNOMIAL * top) << 1 | top) & 0xFFFF_FFFF
    return remainder


class Line:
    """Packets that end behind their CRC, behind one with a wrong bit in its remainder, at once, or one byte later."""

    tail: bytes | None = None  # of the CRC, which has not come

    def __call__(self, model: PacketCheck, pins: Pins) -> None:
        self.tail = self.tail if model.packet else None
        wrong = pins.pop("wrong")
        if pins["in_end"] and self.tail is None and wrong != AT_ONCE:
            crc = zlib.crc32(model.packet) ^ (0 if wrong == GOOD else changed(wrong))
            self.tail = crc.to_bytes(CRC_BYTES, "little")
        if self.tail:
            pins["in_end"] = 0
            if pins["in_valid"]:
                pins["in_data"], self.tail = self.tail[0], self.tail[1:]
        pins["in_valid"] &= not pins["in_end"]


@cocotb.test
async def packets(dut: Any) -> None:
    wrong = [GOOD, AT_ONCE, AT_ONCE, *range(8 * CRC_BYTES)]
    choices = {"in_valid": 1.0, "in_data": WORD, "in_end": 0.4, "in_bad": 0.3, "wrong": wrong}
    await play(dut, PacketCheck(), choices, Line(), clocks=20_000)  # a CRC is slow in Icarus
