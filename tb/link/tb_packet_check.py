# SPDX-License-Identifier: Apache-2.0
"""packet_check against its model in every cycle: short packets, damage, packets that were bad, resets."""

import random
import zlib
from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.link.framing import CRC_BYTES
from tactile_depth.chip.link.packet_check import Checked, PacketCheck
from tb.stream import drive, parametrize
from tb.structures import BOTH, Mutants, Structure

STRUCTURES = (Structure(on=BOTH, mutants=BOTH),)
MUTANTS = Mutants()  # a CRC is slow in Icarus
PROOFS = (
    Proof(
        "the widths in use",
    ),
)


POLYNOMIAL = 0xEDB88320


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


def changed(bit: int) -> int:
    """Return the change of a CRC that changes one bit of the remainder behind it."""
    remainder = 1 << bit
    for _ in range(8 * CRC_BYTES):  # a step of the CRC, backwards
        top = remainder >> 31
        remainder = ((remainder ^ POLYNOMIAL * top) << 1 | top) & 0xFFFF_FFFF
    return remainder


def one_bit_wrong(bit: int, chance: random.Random) -> bytes:
    """Return a packet with one wrong bit in its remainder."""
    body = chance.randbytes(3)
    return body + (zlib.crc32(body) ^ changed(bit)).to_bytes(CRC_BYTES, "little")


def stimuli(packets: list[bytes], gap: float, resets: float, bad: float, chance: random.Random) -> list[dict[str, int]]:
    """Return the pins for packets; so many of them come as bad."""
    clocks: list[dict[str, int]] = []

    def clock(**pins: int) -> None:
        idle = {"in_valid": 0, "in_data": chance.randint(0, 255), "in_end": 0, "in_bad": chance.randint(0, 1)}
        clocks.append({"rst": int(chance.random() < resets), **idle, **pins})

    for whole in packets:
        for byte in whole:
            while chance.random() < gap:
                clock()
            clock(in_valid=1, in_data=byte)
        while chance.random() < gap:
            clock()
        clock(in_end=1, in_bad=int(chance.random() < bad))
    clock()
    return clocks


async def compare(dut: Any, inputs: list[dict[str, int]]) -> list[bool]:
    """Drive the pins, compare the outputs with the model in each clock, and return which packets were good."""
    outputs = await drive(dut, inputs, ["out_valid", "out_data", "out_end", "out_good"])
    model, expected, seen = PacketCheck(), Checked(), []
    for clock, pins in enumerate(inputs):
        valid, ends = int(outputs["out_valid"][clock]), int(outputs["out_end"][clock])
        got = Checked(
            int(outputs["out_data"][clock]) if valid else None,
            bool(ends),
            bool(ends and int(outputs["out_good"][clock])),
        )
        assert got == expected, f"clock {clock}: {got}, expected {expected}"
        seen += [got.good] if got.ends else []
        if pins["rst"]:
            model.reset()
            expected = Checked()
        else:
            byte = pins["in_data"] if pins["in_valid"] else None
            expected = model.clock(byte, bool(pins["in_end"]), bool(pins["in_bad"]))
    return seen


@cocotb.test(timeout_time=20, timeout_unit="ms")
@parametrize(gap=[0.0, 0.4], resets=[0.0, 0.01])
async def packets(dut: Any, gap: float, resets: float) -> None:
    """Check packets that follow each other at once, or with gaps."""
    chance = random.Random(cocotb.RANDOM_SEED)
    seen = await compare(dut, stimuli([packet(chance) for _ in range(60)], gap, resets, 0.15, chance))
    assert {*seen} == {False, True}, "the test is void"


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def remainders(dut: Any) -> None:
    """Check packets whose remainder is wrong in one bit, in each."""
    chance = random.Random(cocotb.RANDOM_SEED)
    seen = await compare(dut, stimuli([one_bit_wrong(bit, chance) for bit in range(32)], 0.0, 0.0, 0.0, chance))
    assert not any(seen)
