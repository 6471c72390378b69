# SPDX-License-Identifier: Apache-2.0
"""zero_capture against its model in every clock."""

import random
from typing import Any

import cocotb

from formal.entries import ROUNDING, Proof
from tactile_depth.chip.depth.zero_capture import LARGEST_LOG2, ZeroCapture
from tactile_depth.chip.fixed_point import joined
from tb.lockstep import CLOCKS, Pins, play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, Structure


def built(*case: int, **runs: Any) -> Structure:
    names = ("Columns", "Rows", "BlockLog2", "Width", "MaxLog2", "Lanes")
    return Structure(dict(zip(names, case, strict=True)), **runs)


STRUCTURES = (
    built(16, 8, 1, 24, 5, 1, on=VERILATOR),
    built(32, 13, 2, 20, 3, 4, on=VERILATOR),
    built(4, 5, 1, 4, 2, 1, on=ICARUS, mutants=ICARUS),
    built(4, 2, 1, 6, 1, 1, on=ICARUS),
    built(16, 11, 2, 5, 2, 2, on=ICARUS),
    built(16, 5, 1, 4, 1, 4, on=ICARUS, mutants=ICARUS),
    built(32, 21, 1, 12, 1, 1),
    built(16, 16, 2, 24, 3, 1),
    built(128, 20, 3, 16, 1, 1),
    built(16, 9, 1, 32, 0, 1),
    built(16, 8, 1, 24, LARGEST_LOG2, 1),
    built(128, 20, 3, 24, 2, 8),
    built(256, 9, 3, 24, 1, 32),
    built(128, 17, 3, 24, 1, 32),
    built(256, 9, 3, 24, 1, 64),
)
PROTOCOL = {
    "raster_places": {"Columns": "Columns / Lanes"},
    "in_frame_start": "in_valid & ~rst ? &place[1:0] : in_frame_start",
    "in_frame_end": "in_valid & ~rst ? &place[3:2] : in_frame_end",
    "counts": "live & ~reset",
    "map_write": "live",
    "map_write_node map_write_zero": "live & map_write",
}
PROOFS = (
    *(
        Proof(
            "two rows of blocks and a cut one, and a single whole one; rows, columns and frames are only counted; a "
            "beat of a block, and of two",
            {"Sums": 0, "Rows": rows, "Columns": 4 * lanes, "Lanes": lanes},
        )
        for rows, lanes in ((5, 1), (2, 1), (3, 2), (3, 4))
    ),
    Proof(f"a cut row of blocks; sums are exact at any width; {ROUNDING}", {"Sums": 1, "Rows": 3}),
)


def legal(capture: ZeroCapture, pins: Pins) -> None:
    """Mark the first and the last beat of a frame; request a capture anew with `again` only."""
    if pins["in_valid"]:
        pins["in_frame_start"] = capture.place == 0
        pins["in_frame_end"] = capture.place == capture.size - 1
    again = pins.pop("again")
    pins["request"] = again or (pins["request"] and not capture.busy)


@cocotb.test
async def captures(dut: Any) -> None:
    numbers = parameters(dut, "Rows", "Columns", "BlockLog2", "Width", "MaxLog2", "Lanes")
    *_, width, _, lanes = numbers
    limits = [joined([word] * lanes, width) for word in (1 << width - 1, (1 << width - 1) - 1)]
    chance = random.Random(cocotb.RANDOM_SEED)
    words = [*limits, *limits, *(chance.getrandbits(lanes * width) for _ in range(40))]
    choices: dict[str, Any] = dict.fromkeys(("en", "in_valid", "in_frame_start", "in_frame_end", "request"), 1.0)
    choices |= {"rst": 0.005, "again": 0.01, "in_data": words, "log2_frames": (1, 0, *range(16))}
    await play(dut, ZeroCapture(*numbers), choices, legal, clocks=3 * CLOCKS)
