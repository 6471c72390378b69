# SPDX-License-Identifier: Apache-2.0
"""frame_marks against its model in every clock, with small counts, so that each gets to its largest number."""

from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.gradient.frame_marks import STAGES, FrameMarks
from tb.lockstep import WORD, Pins, play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Width Pixels CountBits")
STRUCTURES = (
    built(21, 128, 16, on=VERILATOR, mutants=ICARUS),
    built(15, 31, 4, on=ICARUS, mutants=ICARUS),
    built(7, 15, 4),
)
PROTOCOL = {"counts": "live", "out_flags": "live & out_valid"}
PROOFS = (Proof("a count goes on by one, or stays", {"Width": 10, "Pixels": 9, "CountBits": 3}),)


@cocotb.test()
async def frames(dut: Any) -> None:
    width, pixels, bits = parameters(dut, "Width", "Pixels", "CountBits")

    def legal(model: FrameMarks, pins: Pins) -> None:
        """Give a frame no more pixels than it has."""
        pins["dark"] &= model.dark < pixels
        pins["slope_valid"] &= model.steep < pixels - 1

    pins: dict[str, Any] = {"en": 1.0, "dark": 1.0, "slope_valid": 1.0, "slope_limit": WORD, "resumed": 0.5}
    pins |= {"light_gains": WORD, "light_moves": 0.5, "slope_gx": WORD, "slope_gy": WORD}
    pins |= {f"{stage}_ends": 0.2 for stage in STAGES} | {f"{stage}_clipped": 0.1 for stage in STAGES}
    await play(dut, FrameMarks(width, (1 << bits) - 1), pins, legal)
