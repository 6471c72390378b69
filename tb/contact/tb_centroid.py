# SPDX-License-Identifier: Apache-2.0
"""centroid against its model: means at ties, beside them and at the limits; restarts, resets, one after another."""

import random
from typing import Any

import cocotb

from formal.entries import ROUNDING, Proof
from tactile_depth.chip.contact import centroid
from tactile_depth.chip.contact.centroid import cycles, mean
from tb.stream import drive, parameters
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("PositionWidth WeightWidth")
STRUCTURES = (
    built(7, 38, on=VERILATOR),
    built(3, 6, on=ICARUS, mutants=ICARUS),
    built(10, 52),
    built(2, 4),
    built(5, 9),
)
PROOFS = (
    Proof(
        f"every weight and moment of this width; a bit is found in the same way at any width; {ROUNDING}",
        {"Latency": centroid.cycles(2)},
    ),
)


def moments(position_bits: int, weight: int, chance: random.Random) -> list[int]:
    """Return moments of a weight: ends of the range, ties, neighbours of ties, random ones."""
    largest = weight * ((1 << position_bits) - 1)
    near = [weight * chance.randrange(32 << position_bits) // 32 + chance.choice([-1, 0, 1]) for _ in range(3)]
    return [min(max(moment, 0), largest) for moment in (0, largest, *near, chance.randint(0, largest))]


@cocotb.test()
async def means(dut: Any) -> None:
    """Check that each `done` comes at its latency after the last start with both means, and none after a reset."""
    position_bits, weight_bits = parameters(dut, "PositionWidth", "WeightWidth")
    chance = random.Random(cocotb.RANDOM_SEED)
    latency = cycles(position_bits)
    weights = [1, 2, 3, 32, 33, (1 << weight_bits) - 1, 1 << weight_bits - 1]
    weights += [1 << chance.randrange(weight_bits) for _ in range(60)]
    weights += [chance.randint(1, (1 << weight_bits) - 1) for _ in range(60)]
    stimuli: list[dict[str, int]] = []
    for weight in (weight for weight in weights if weight < 1 << weight_bits):
        columns, rows = chance.sample(moments(position_bits, weight, chance), 2)
        length = chance.choice([latency, latency, 2 * latency, chance.randint(1, latency)])
        reset = chance.randrange(length) if chance.random() < 0.1 else 0
        for clock in range(length):
            stimuli.append(
                {
                    "rst": 0 < clock == reset,
                    "start": clock == 0,
                    "column_moment": columns if clock == 0 else chance.getrandbits(weight_bits + position_bits),
                    "row_moment": rows,
                    "weight": weight,
                }
            )
    stimuli += [stimuli[-1] | {"rst": 0, "start": 0}] * (latency + 1)  # row_moment and weight are held
    outputs = await drive(dut, stimuli, ["done", "column", "row"])
    due: dict[int, tuple[int, int]] = {}
    finished = 0
    for clock, pins in enumerate(stimuli):
        expected = due.pop(clock, None)
        assert bool(outputs["done"][clock]) == (expected is not None), f"done in clock {clock}"
        if expected is not None:
            finished += 1
            seen = int(outputs["column"][clock]), int(outputs["row"][clock])
            assert seen == expected, f"{seen} in clock {clock}, expected {expected}: {pins}"
        if pins["rst"] or pins["start"]:
            due.clear()
        if pins["start"] and not pins["rst"]:
            given = pins["column_moment"], pins["row_moment"]
            due[clock + latency] = tuple(mean(moment, pins["weight"], position_bits) for moment in given)  # type: ignore[assignment]
    assert finished > 70
