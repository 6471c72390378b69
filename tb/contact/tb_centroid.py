# SPDX-License-Identifier: Apache-2.0
"""centroid against its model: means at ties, beside them and at the limits; restarts, resets, one after another."""

import random
from typing import Any

import cocotb

from tactile_depth.contact.centroid import cycles, mean
from tb.stream import drive, parameters


def totals(position_bits: int, area: int, chance: random.Random) -> list[int]:
    """Return sums of `area` positions: ends of the range, ties, neighbours of ties, random ones."""
    largest = min(area * ((1 << position_bits) - 1), 2 ** (area.bit_length() + position_bits - 1) - 1)
    near = [area * chance.randrange(32 << position_bits) // 32 + chance.choice([-1, 0, 1]) for _ in range(3)]
    return [min(max(total, 0), largest) for total in (0, largest, *near, chance.randint(0, largest))]


@cocotb.test()
async def means(dut: Any) -> None:
    """Check that each `done` comes at its latency after the last start with both means, and none after a reset."""
    position_bits, area_bits = parameters(dut, "PositionWidth", "AreaWidth")
    chance = random.Random(cocotb.RANDOM_SEED)
    latency = cycles(position_bits)
    areas = [1, 2, 3, 32, 33, (1 << area_bits) - 1, 1 << area_bits - 1]
    areas += [1 << chance.randrange(area_bits) for _ in range(60)]
    areas += [chance.randint(1, (1 << area_bits) - 1) for _ in range(60)]
    stimuli: list[dict[str, int]] = []
    for area in (area for area in areas if area < 1 << area_bits):
        columns, rows = chance.sample(totals(position_bits, area, chance), 2)
        length = chance.choice([latency, latency, 2 * latency, chance.randint(1, latency)])
        reset = chance.randrange(length) if chance.random() < 0.1 else 0
        for clock in range(length):
            stimuli.append(
                {
                    "rst": 0 < clock == reset,
                    "start": clock == 0,
                    "column_sum": columns if clock == 0 else chance.getrandbits(area_bits + position_bits - 1),
                    "row_sum": rows,
                    "area": area,
                }
            )
    stimuli += [{"rst": 0, "start": 0, "column_sum": 0, "row_sum": 0, "area": 1}] * (latency + 1)
    outputs = await drive(dut, stimuli, ["done", "column", "row"])
    due: dict[int, tuple[int, int]] = {}
    finished = 0
    for clock, pins in enumerate(stimuli):
        expected = due.pop(clock, None)
        assert bool(outputs["done"][clock]) == (expected is not None), f"done in clock {clock}"
        if expected is not None:
            finished += 1
            assert (int(outputs["column"][clock]), int(outputs["row"][clock])) == expected, f"in clock {clock}"
        if pins["rst"] or pins["start"]:
            due.clear()
        if pins["start"] and not pins["rst"]:
            sums = pins["column_sum"], pins["row_sum"]
            due[clock + latency] = tuple(mean(total, pins["area"], position_bits) for total in sums)  # type: ignore[assignment]
    assert finished > 70
