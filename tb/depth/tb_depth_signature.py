# SPDX-License-Identifier: Apache-2.0
"""depth_signature against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.common.signature import START
from tactile_depth.chip.depth.depth_signature import DepthSignature
from tb.lockstep import WORD, Pins, play
from tb.stream import parameters
from tb.structures import BOTH, ICARUS, of_parameters

built = of_parameters("Width Lanes")
STRUCTURES = (built(15, 1, on=BOTH), built(12, 4, on=ICARUS), built(6, 2, mutants=ICARUS), built(32, 2))
PROTOCOL = {"counts": "live & ~reset"}
PROOFS = tuple(
    Proof("every code is folded alike; one code of a beat, and four", {"Width": 12, "Lanes": lanes}) for lanes in (1, 4)
)


@cocotb.test()
async def frames(dut: Any) -> None:
    marks = {"in_valid": 1.0, "in_frame_start": 0.1, "in_frame_end": 0.1}
    choices = {"en": 1.0, "clear": 0.02, **marks, "in_data": WORD}

    def legal(model: DepthSignature, pins: Pins) -> None:
        """Let the first beat of all begin a frame."""
        pins["in_frame_start"] |= model.sum == START

    await play(dut, DepthSignature(*parameters(dut, "Width", "Lanes")), choices, legal)
