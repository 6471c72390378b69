# SPDX-License-Identifier: Apache-2.0
"""frame_tags against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.depth.frame_tags import FrameTags
from tb.lockstep import WORD, Pins, play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, of_parameters

# Two frames in flight, one, exactly two, four; the first again, for mutants.
built = of_parameters("Width Latency Pixels")
STRUCTURES = (
    built(33, 37, 24, on=VERILATOR),
    built(4, 9, 16, on=ICARUS),
    built(33, 32, 16),
    built(33, 50, 13),
    built(4, 9, 6, mutants=ICARUS),
)
PROOFS = tuple(
    Proof(f"one, two and three places; {WORD_FREE}", {"Latency": latency, "Pixels": pixels})
    for latency, pixels in ((3, 4), (5, 4), (7, 3))
)


@cocotb.test()
async def tags(dut: Any) -> None:
    latency, pixels = parameters(dut, "Latency", "Pixels")

    def legal(model: FrameTags, pins: Pins) -> None:
        """Push no sooner than a frame behind the last push."""
        pins["push"] &= all(model.now >= due - latency + pixels for due in model.due_clock)

    await play(dut, FrameTags(latency), {"en": 1.0, "push": 1.0, "tag": WORD}, legal)
