# SPDX-License-Identifier: Apache-2.0
"""cobs_encode against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.link.cobs_encode import CobsEncode
from tb.lockstep import WORD, play
from tb.stream import parameters
from tb.structures import BOTH, ICARUS, Mutants, of_parameters

built = of_parameters("Run")
STRUCTURES = (built(254, on=BOTH), built(3, on=ICARUS, mutants=ICARUS), built(2))
MUTANTS = Mutants(repeats=2)
PROTOCOL = {"counts": "live & ~reset", "out_data": "counts & out_valid"}
PROOFS = tuple(Proof("COBS; runs that traces show; any byte is followed", {"Run": run}, steps=2) for run in (254, 3, 2))


@cocotb.test
async def packets(dut: Any) -> None:
    choices = {"in_valid": 1.0, "in_data": WORD, "in_last": 0.3, "out_ready": 1.0}
    await play(dut, CobsEncode(*parameters(dut, "Run")), choices, offers=["in"])
