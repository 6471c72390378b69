# SPDX-License-Identifier: Apache-2.0
"""light_gains against its model in every clock."""

import random
from typing import Any

import cocotb

from formal.entries import ROUNDING, Proof
from tactile_depth.chip.fixed_point import Format
from tactile_depth.chip.gradient.light_gains import Light, LightGains
from tb.lockstep import CLOCKS, WORD, Pins, play
from tb.stream import parameters, raster
from tb.structures import ICARUS, VERILATOR, Structure


def built(rows: int, columns: int, *widths: Any, **runs: Any) -> Structure:
    return Structure(Light(rows, columns, *widths).parameters, **runs)


SMALL = 8, 6, 8, Format(7, 5)
STRUCTURES = (
    built(8, 16, on=VERILATOR),
    built(3, 10, *SMALL, on=ICARUS, mutants=ICARUS),
    built(9, 32),
    built(2, 11, *SMALL),
)
PROTOCOL = {
    "raster_places": {},
    "in_position": "place",
    "counts": "live & ~reset & en",
    "gains used": "live",
    "moves": "live & in_valid & in_position[3] & in_position[2]",
    "saturations flipped": "live & ~reset",
    "out_position out_red out_green out_blue": "counts & out_valid",
}
PROOFS = (
    Proof(
        f"products are exact at any width; rows and columns are only counted; {ROUNDING}",
        {"Moves": 0, "RatioWidth": 3, "GainWidth": 4, "OutWidth": 5, "OutFraction": 3},
    ),
    Proof(
        "sums are exact at any width; the shortest row leaves the least time; deviations of any value",
        {"Moves": 1},
        steps=3,
        free=("deviations",),
    ),
)


WIDTHS = ("Rows", "Columns", "RatioWidth", "RatioFraction", "GainWidth", "OutWidth", "OutFraction")
COLOURS = ("red", "green", "blue")


@cocotb.test()
async def frames(dut: Any) -> None:
    rows, columns, ratio_width, ratio_fraction, gain_width, width, fraction = parameters(dut, *WIDTHS)
    light = Light(rows, columns, ratio_width, ratio_fraction, gain_width, Format(width, fraction))
    marks, near, chance = raster(rows, columns), 2 * light.near, random.Random(cocotb.RANDOM_SEED)
    drawn_of: dict[str, list[int]] = {}
    drop = ratio_fraction + gain_width - 1 - fraction

    def legal(model: LightGains, pins: Pins) -> None:
        """Place each pixel in its frame; its ratios have a few deviations that are drawn for it, or any, or are 0."""
        if not model.frame:
            drawn_of.update({colour: chance.choices(deviations, k=8) for colour in COLOURS})
        bad, black, drawn = (pins.pop(name) for name in ("bad", "black", "drawn"))
        if pins["in_valid"]:
            pins["in_position"] = marks[len(model.frame)]
            pins["in_bad"] |= bad and len(model.frame) == len(marks) - 1
        for colour, gain in zip(COLOURS, model.used.tolist(), strict=True):
            wanted = (light.unity << ratio_fraction) + (drawn_of[colour][pins.pop(colour)] << drop - 1)
            if drawn or black:
                pins[f"in_{colour}"] = 0 if black else min((wanted + gain // 2) // gain, (1 << ratio_width) - 1)
        pins["write"] *= pins.pop("writes")

    small = [chance.randrange(-near, near) for _ in range(12)]  # in half steps: ties too
    deviations = [0, *small, *3 * (near, -near), near - 1, 1 - near, near - 2, 2 - near, 1, -1, 2 * near, -2 * near]
    pins: dict[str, Any] = dict.fromkeys(("en", "in_valid", "follow", "drawn"), 1.0)
    pins |= dict.fromkeys(("rst", "writes", "in_bad"), 0.003) | {"bad": 0.3, "black": 0.1, "rate": range(8)}
    pins |= {"write": range(8), "write_gain": WORD, "in_position": range(16)}
    pins |= {f"in_{colour}": WORD for colour in COLOURS} | dict.fromkeys(COLOURS, range(8))
    await play(dut, LightGains(light), pins, legal, clocks=3 * CLOCKS)
