# SPDX-License-Identifier: Apache-2.0
"""cobs_decode against its model in every cycle: packets, runs, damage, broken bytes, pieces too long, resets."""

import random
from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.link.cobs_decode import LONGEST_PIECE, CobsDecode, Decoded
from tactile_depth.chip.link.framing import RUN, cobs_encode
from tb.stream import drive, parameters, parametrize
from tb.structures import BOTH, ICARUS, VERILATOR, of_parameters

built = of_parameters("Longest")
STRUCTURES = (
    built(LONGEST_PIECE, on=VERILATOR),
    built(300, on=BOTH, mutants=BOTH),
    built(2, on=ICARUS),
)
PROTOCOL = {
    "holds": "~(in_valid & in_broken)",
    "counts": "live",
    "out_data": "live & out_valid",
    "out_bad": "live & out_end",
}
PROOFS = (
    Proof(
        "the length of a piece is only counted",
        {"Longest": 5},
        steps=3,
    ),
)


LENGTHS = (*range(8), 16, RUN - 1, RUN, RUN + 1, 2 * RUN, 2 * RUN + 1)  # of data
BROKEN = -1


def piece(kind: str, longest: int, chance: random.Random) -> list[int]:
    """Return what lies between two delimiters."""
    zeros = chance.choice([0.0, 0.02, 0.5])
    count = chance.choice(LENGTHS)
    data = bytes(
        0 if chance.random() < zeros else chance.choice([1, 255, chance.randint(1, 255)]) for _ in range(count)
    )
    bytes_of = list(cobs_encode(data))
    place = chance.randrange(len(bytes_of))
    match kind:
        case "empty":
            return []
        case "changed":
            bytes_of[place] = chance.randint(1, 255)
        case "cut":
            del bytes_of[place:]
        case "extra":
            bytes_of += [chance.choice([1, 2, 255])] * chance.randint(1, 3)
        case "broken":
            bytes_of[place : place + chance.randint(0, 1)] = [BROKEN]
        case "random":
            bytes_of = [chance.choice([1, 1, 2, 3, chance.randint(1, 255)]) for _ in range(chance.randint(1, 12))]
        case "longest":
            bytes_of = [chance.choice([1, 2, 2])] * (longest + chance.choice([-1, 0, 0, 1, 1, 2]))
    return bytes_of


def stimuli(longest: int, kinds: list[str], gap: float, resets: float, chance: random.Random) -> list[dict[str, int]]:
    """Return the pins for a line of pieces; the first ones come before any delimiter."""
    line: list[int] = []
    for kind in kinds:
        line += [*piece(kind, longest, chance), 0]
    clocks = []
    for byte in line:
        while chance.random() < gap:
            clocks.append((0, chance.choice([0, chance.randint(0, 255)]), 0))
        clocks.append((int(byte != BROKEN), chance.choice([0, 77]) if byte == BROKEN else byte, int(byte == BROKEN)))
    clocks += [(0, 0, 0)] * 2
    pins = ("in_valid", "in_data", "in_broken")
    return [{"rst": int(chance.random() < resets), **dict(zip(pins, clock, strict=True))} for clock in clocks]


async def compare(dut: Any, inputs: list[dict[str, int]], longest: int) -> list[Decoded]:
    """Drive the pins, compare the outputs with the model in each clock, and return them."""
    outputs = await drive(dut, inputs, ["out_valid", "out_data", "out_end", "out_bad"])
    model, expected = CobsDecode(longest), Decoded()
    seen = []
    for clock, pins in enumerate(inputs):
        valid, ends = int(outputs["out_valid"][clock]), int(outputs["out_end"][clock])
        got = Decoded(
            int(outputs["out_data"][clock]) if valid else None,
            bool(ends),
            bool(ends and int(outputs["out_bad"][clock])),
        )
        assert got == expected, f"clock {clock}: {got}, expected {expected}"
        seen.append(got)
        if pins["rst"]:
            model.reset()
            expected = Decoded()
        else:
            expected = model.clock(pins["in_data"] if pins["in_valid"] else None, bool(pins["in_broken"]))
    return seen


KINDS = ("whole", "whole", "whole", "empty", "changed", "cut", "extra", "broken", "random", "longest")


@cocotb.test(timeout_time=20, timeout_unit="ms")
@parametrize(gap=[0.0, 0.4], resets=[0.0, 0.01])
async def pieces(dut: Any, gap: float, resets: float) -> None:
    """Decode good and bad pieces in any order, the first of them before a delimiter."""
    (longest,) = parameters(dut, "Longest")
    chance = random.Random(cocotb.RANDOM_SEED)
    kinds = [chance.choice(KINDS) for _ in range(60 if longest < LONGEST_PIECE else 20)]
    seen = await compare(dut, stimuli(longest, ["random", *kinds], gap, resets, chance), longest)
    assert {one.bad for one in seen if one.ends} == {False, True}, "the test is void"


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def lengths(dut: Any) -> None:
    """Decode pieces as long as a piece may be, and longer; one byte; a broken byte alone, and as one too many."""
    (longest,) = parameters(dut, "Longest")
    line = []
    powers = [1 << bit for bit in range(longest.bit_length())]  # each bit of the length alone
    for length in (*powers, longest, longest + 1, longest, 1, longest + 2, 2 * longest + 3, longest):
        line += [0, *[1] * length]
    line += [
        0,
        BROKEN,
        0,
        1,
        0,
        BROKEN,
        1,
        1,
        0,
        *[1] * longest,
        BROKEN,
        0,
        *[1] * (longest + 1),
        BROKEN,
        1,
        0,
        2,
        2,
        0,
    ]
    line += [0, 1, BROKEN, 1, 0, 1, 1, 0]
    chance = random.Random(cocotb.RANDOM_SEED)
    pins = [
        {"rst": 0, "in_valid": int(byte != BROKEN), "in_data": max(byte, 0), "in_broken": int(byte == BROKEN)}
        for byte in [chance.randint(1, 9), BROKEN, *line]
    ]
    calm = {"rst": 0, "in_valid": 0, "in_data": 0, "in_broken": 0}
    seen = await compare(dut, [*pins, calm, calm], longest)
    ends = [not one.bad for one in seen if one.ends]
    assert ends[: len(powers)] == [True] * len(powers)
    ends = ends[len(powers) :]
    assert ends == [True, False, True, True, False, False, True, False, True, *[False] * 3, True, False, True], ends
