# SPDX-License-Identifier: Apache-2.0
"""packet_check against its model in every cycle: short packets, damage, packets that were bad, resets."""

import random
import zlib
from typing import Any

import cocotb

from tactile_depth.link.framing import CRC_BYTES
from tactile_depth.link.packet_check import Checked, PacketCheck
from tb.stream import drive


def packet(chance: random.Random) -> bytes:
    """Return a packet that is good, has a bit changed, a byte lost or swapped, or is short."""
    body = chance.randbytes(chance.choice([0, 1, 1, 2, 3, 4, 5, 9, 30]))
    whole = bytearray(body + zlib.crc32(body).to_bytes(CRC_BYTES, "little"))
    place = chance.randrange(len(whole))
    match chance.randrange(8):
        case 0:
            whole[place] ^= 1 << chance.randrange(8)
        case 1:
            del whole[place]
        case 2:
            return chance.randbytes(chance.randint(0, CRC_BYTES + 1))
        case 3:
            whole[-CRC_BYTES:] = whole[: -CRC_BYTES - 1 : -1]
    return bytes(whole)


def stimuli(gap: float, resets: float, chance: random.Random) -> list[dict[str, int]]:
    """Return the pins for packets, some of them bad."""
    clocks: list[dict[str, int]] = []

    def clock(**pins: int) -> None:
        idle = {"in_valid": 0, "in_data": chance.randint(0, 255), "in_end": 0, "in_bad": chance.randint(0, 1)}
        clocks.append({"rst": int(chance.random() < resets), **idle, **pins})

    for _ in range(120):
        for byte in packet(chance):
            while chance.random() < gap:
                clock()
            clock(in_valid=1, in_data=byte)
        while chance.random() < gap:
            clock()
        clock(in_end=1, in_bad=int(chance.random() < 0.15))
    clock()
    return clocks


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(gap=[0.0, 0.4], resets=[0.0, 0.01])
async def packets(dut: Any, gap: float, resets: float) -> None:
    """Check packets that follow each other at once, or with gaps."""
    inputs = stimuli(gap, resets, random.Random(cocotb.RANDOM_SEED))
    outputs = await drive(dut, inputs, ["out_valid", "out_data", "out_end", "out_good"])
    model, expected = PacketCheck(), Checked()
    seen = set()
    for clock, pins in enumerate(inputs):
        valid, ends = int(outputs["out_valid"][clock]), int(outputs["out_end"][clock])
        got = Checked(
            int(outputs["out_data"][clock]) if valid else None,
            bool(ends),
            bool(ends and int(outputs["out_good"][clock])),
        )
        assert got == expected, f"clock {clock}: {got}, expected {expected}"
        seen |= {got.good} if got.ends else set()
        if pins["rst"]:
            model.reset()
            expected = Checked()
        else:
            byte = pins["in_data"] if pins["in_valid"] else None
            expected = model.clock(byte, bool(pins["in_end"]), bool(pins["in_bad"]))
    assert seen == {False, True}, "the test is void"
