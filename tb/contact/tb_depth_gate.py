# SPDX-License-Identifier: Apache-2.0
"""depth_gate against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.contact.depth_gate import DepthGate
from tb.lockstep import WORD, Pins, play
from tb.stream import depth_position
from tb.structures import BOTH, ICARUS, Structure

STRUCTURES = (Structure({"Width": 12}, on=BOTH, mutants=ICARUS),)
PROOFS = (Proof(f"words of a frame are only counted; {WORD_FREE}"),)


def legal(model: DepthGate, pins: Pins) -> None:
    """Bring the words of a frame in successive enabled cycles, with their marks."""
    pins["in_valid"] |= model.inside
    pins["in_position"] = depth_position(not model.inside, pins.pop("row_end"), pins.pop("frame_end"))


@cocotb.test()
async def words(dut: Any) -> None:
    bits = {"in_valid": 1.0, "row_end": 0.5, "frame_end": 0.4, "m_ready": 1.0, "drop_frames": 1.0}
    await play(dut, DepthGate(), {**bits, "in_data": WORD}, legal)
