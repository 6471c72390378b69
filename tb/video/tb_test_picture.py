# SPDX-License-Identifier: Apache-2.0
"""test_picture against its model in every clock, in front of a guard of 4 x 8 pixels that is its model too."""

from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.video.frame_guard import FrameGuard
from tactile_depth.chip.video.test_picture import Picture
from tb.lockstep import WORD, Pins, play
from tb.structures import BOTH, ICARUS, Structure

STRUCTURES = (Structure(on=BOTH, mutants=ICARUS),)
PROTOCOL = {"counts": "live & ~reset", "m_data m_last m_user": "counts & m_valid"}
PROOFS = (Proof("no parameter but the seed, which is the first pixel"),)


@cocotb.test()
async def pictures(dut: Any) -> None:
    guard = FrameGuard(4, 8)

    def legal(core: Picture, pins: Pins) -> None:
        """Let the guard behind take pixels of the picture, and at times of the stream."""
        left = guard.rows * guard.columns - len(guard.pixels)
        pins |= {"between": left == 32, "row_ends": left % 8 == 1, "frame_ends": left == 1}
        test = core.waiting and (core.begun or left == 32)
        if pins["rst"] or (pins["m_ready"] and left == 1 and (test or pins["s_valid"])):
            guard.pixels = []
        elif pins["m_ready"] and (test or pins["s_valid"]):
            guard.pixels.append(0)

    choices = {"request": 0.1, "s_valid": 1.0, "s_data": WORD, "s_last": 1.0, "s_user": 1.0, "m_ready": 1.0}
    await play(dut, Picture(), choices, legal, ("s",))
