# SPDX-License-Identifier: Apache-2.0
"""reference_capture against its model in every clock."""

import random
from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.fixed_point import joined
from tactile_depth.chip.gradient.reference_capture import ReferenceCapture
from tb.lockstep import CLOCKS, WORD, Pins, play
from tb.stream import parameters, raster
from tb.structures import ICARUS, VERILATOR, of_parameters

NAMES = "Rows Columns BlockLog2 Width GainFraction MaxLog2"
built = of_parameters(NAMES)
STRUCTURES = (
    built(8, 16, 1, 24, 27, 5, on=VERILATOR),
    built(8, 16, 1, 17, 20, 2, on=ICARUS, mutants=ICARUS),
    built(16, 16, 1, 24, 27, 3),
    built(21, 32, 1, 24, 27, 3),
    built(8, 128, 3, 24, 27, 4),
    built(8, 128, 3, 17, 20, 3),
    built(8, 16, 1, 24, 27, 8),
)
PROTOCOL = {
    "raster_places": {},
    "in_position": "in_valid & ~rst ? place : in_position",
    "counts": "live & ~reset",
    "map_write_node map_write_gains": "counts & map_write",
    "map_read_node": "counts & map_read",
}
PROOFS = tuple(
    Proof(
        "a cut row of blocks; rows, columns and frames are only counted; sums are exact at any width"
        + (", whatever the divider writes behind them" if sums else ""),
        {"Sums": sums},
        free=("word",) if sums else (),
    )
    for sums in (0, 1)
)


@cocotb.test()
async def captures(dut: Any) -> None:
    rows, columns, _, width, *_ = numbers = parameters(dut, *NAMES.split())
    marks, chance = raster(rows, columns), random.Random(cocotb.RANDOM_SEED)

    def legal(capture: ReferenceCapture, pins: Pins) -> None:
        """Place each pixel in its frame; request a capture anew with `again` only."""
        if pins["in_valid"]:
            pins["in_position"] = marks[capture.place]
        again = pins.pop("again")
        pins["request"] = again or (pins["request"] and not capture.busy)

    sums = [joined([chance.getrandbits(chance.randint(1, width)) for _ in range(3)], width) for _ in range(999)]
    choices: dict[str, Any] = dict.fromkeys(("en", "in_valid", "request"), 1.0) | dict.fromkeys(("rst", "again"), 0.001)
    choices |= {"in_bad": 0.3, "in_pixel": WORD, "in_position": range(16), "log2_frames": (1, 0, *range(16))}
    await play(dut, ReferenceCapture(*numbers), choices | {"map_read_gains": sums}, legal, clocks=3 * CLOCKS)
