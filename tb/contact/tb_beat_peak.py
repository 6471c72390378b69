# SPDX-License-Identifier: Apache-2.0
"""beat_peak against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.contact.beat_peak import BeatPeak
from tb.contact.beats import beats
from tb.lockstep import play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Width Lanes")
STRUCTURES = (
    built(24, 8, on=VERILATOR),
    built(6, 4, on=ICARUS, mutants=ICARUS),
    built(6, 2, on=ICARUS),
    built(32, 32),
    built(12, 16),
)
PROOFS = (Proof("comparisons are exact at any width"),)


@cocotb.test()
async def depths(dut: Any) -> None:
    width, lanes = parameters(dut, "Width", "Lanes")
    await play(dut, BeatPeak(width, lanes), {"data": beats(width, lanes)})
