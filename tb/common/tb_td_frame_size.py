# SPDX-License-Identifier: Apache-2.0
"""td_frame_size against its model in every clock; the counts are small, so that each gets to its largest number."""

from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.common.td_frame_size import FrameSize
from tb.lockstep import Pins, play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("CountWidth WordsPerPixel")
STRUCTURES = (built(3, 1, on=VERILATOR, mutants=ICARUS), built(3, 2, on=ICARUS, mutants=ICARUS), built(14, 1))
REFUSED = {
    "CountWidth_must_be_at_least_2": "CountWidth=1",
    "WordsPerPixel_must_be_a_power_of_two": "WordsPerPixel=3",
}
PROTOCOL = {"counts": "live"}
PROOFS = tuple(
    Proof("a count goes on by one, or stands, or begins again", {"CountWidth": 3, "WordsPerPixel": words})
    for words in (1, 2)
)


@cocotb.test()
async def sizes(dut: Any) -> None:
    def legal(core: FrameSize, pins: Pins) -> None:
        """End a row at times, and start a frame where a row begins, now and then inside one."""
        pins["in_user"] &= pins.pop("anywhere") | (not core.words)

    pins = {"in_valid": 1.0, "in_last": [0, 0, 1, 0, 0, 1, 0, 0, 0, 0], "in_user": 0.2, "anywhere": 0.2}
    count_width, words_per_pixel = parameters(dut, "CountWidth", "WordsPerPixel")
    await play(dut, FrameSize(count_width, words_per_pixel), pins, legal)
