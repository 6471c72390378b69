# SPDX-License-Identifier: Apache-2.0
"""frame_output against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.depth.frame_output import FrameOutput
from tb.lockstep import WORD, Pins, play
from tb.stream import parameters
from tb.structures import BOTH, ICARUS, Structure

STRUCTURES = (
    Structure({"Width": 24, "Rows": 4, "Columns": 8}, on=BOTH),
    Structure({"Width": 12, "Rows": 16, "Columns": 2}, on=BOTH, mutants=ICARUS),
)
PROTOCOL = {"counts": "live & ~reset & en", "out_data": "counts & out_valid"}
PROOFS = (Proof(f"rows and columns are only counted; {WORD_FREE}", {"Rows": 3, "Columns": 4}),)


def legal(model: FrameOutput, pins: Pins) -> None:
    """Begin bursts and frames where they should, but for a drawn 1."""
    place = 0 if pins["in_due"] else model.place
    pins["in_start"] ^= place < model.size and place % model.columns == 0
    pins["in_frame_start"] ^= pins["in_due"]


@cocotb.test
async def frames(dut: Any) -> None:
    choices = {"en": 1.0, "in_start": 0.3, "in_frame_start": 0.3, "in_data": WORD, "in_due": 0.1, "in_bad": 1.0}
    await play(dut, FrameOutput(*parameters(dut, "Rows", "Columns")), choices, legal)
