# SPDX-License-Identifier: Apache-2.0
"""flip_marks against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.contact.flip_marks import FlipMarks
from tb.lockstep import play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Records")
STRUCTURES = (
    built(3, on=VERILATOR),
    built(1, on=ICARUS, mutants=ICARUS),
    built(4, on=ICARUS, mutants=ICARUS),
    built(7),
)
PROTOCOL = {"counts": "live"}
PROOFS = (Proof("the size in use for most grids", {"Records": 3}), Proof("a count that fills its bits", {"Records": 1}))


@cocotb.test
async def marks_of_records(dut: Any) -> None:
    (records,) = parameters(dut, "Records")
    await play(dut, FlipMarks(records), {"flipped": 0.3, "record_valid": 1.0})
