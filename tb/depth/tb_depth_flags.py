# SPDX-License-Identifier: Apache-2.0
"""depth_flags against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import FULL_WIDTH, Proof
from tactile_depth.chip.depth.depth_flags import DepthFlags
from tb.lockstep import WORD, play
from tb.structures import BOTH, ICARUS, Structure

STRUCTURES = (Structure({}, on=BOTH, mutants=ICARUS),)
PROTOCOL = {"counts": "live"}
PROOFS = (Proof(FULL_WIDTH),)


@cocotb.test
async def flags(dut: Any) -> None:
    choices = {"en": 1.0, "frame_start": 0.2, "solver_clipped": 0.2, "in_flags": WORD, "marked": 0.5}
    choices |= {"zero_clipped": 0.2, "depth_starts": 0.3, "depth_ends": 0.3}
    await play(dut, DepthFlags(), choices)
