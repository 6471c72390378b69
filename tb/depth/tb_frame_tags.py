# SPDX-License-Identifier: Apache-2.0
"""frame_tags against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.depth.frame_tags import FrameTags
from tb.lockstep import WORD, Pins, play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, of_parameters

# Two frames in flight, one, exactly two, four, and a place more since a part is kept; the first again, for mutants.
built = of_parameters("Width LateWidth Latency Keep Pixels")
STRUCTURES = (
    built(33, 7, 37, 5, 24, on=VERILATOR),
    built(4, 7, 9, 6, 16, on=ICARUS),
    built(33, 7, 30, 2, 16),
    built(33, 96, 50, 12, 13),
    built(4, 3, 10, 3, 6, mutants=ICARUS),
    built(4, 3, 9, 6, 16, mutants=ICARUS),
)
PROOFS = tuple(
    Proof(
        f"one, two and three places; {WORD_FREE}",
        {"Width": 1, "LateWidth": 1, "Latency": latency, "Keep": keep, "Pixels": pixels},
    )
    for latency, keep, pixels in ((3, 1, 4), (4, 2, 4), (7, 2, 3))
)


@cocotb.test
async def tags(dut: Any) -> None:
    latency, keep, pixels = parameters(dut, "Latency", "Keep", "Pixels")

    def legal(model: FrameTags, pins: Pins) -> None:
        """Push no sooner than a frame behind the last push."""
        pins["push"] &= model.pushed is None or model.now >= model.pushed.due + pixels - latency

    choices = {"en": 1.0, "push": 1.0, "tag": WORD, "marked": 0.3, "late": 0.5, "late_part": WORD, "mark": 0.03}
    await play(dut, FrameTags(latency, keep), choices, legal)
