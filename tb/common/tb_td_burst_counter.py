# SPDX-License-Identifier: Apache-2.0
"""td_burst_counter against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.common.td_burst_counter import BurstCounter
from tb.lockstep import play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Words")
STRUCTURES = (built(16, on=VERILATOR), built(8, on=ICARUS, mutants=ICARUS), built(64))
REFUSED = {"Words_must_be_at_least_2": "Words=1"}
PROTOCOL = {"counts": "live", "position": "live & active"}
PROOFS = tuple(
    Proof(why, {"Words": words})
    for words, why in ((2, "the smallest"), (8, "one of which a trace shows two bursts"), (1024, "the longest in use"))
)


@cocotb.test()
async def positions(dut: Any) -> None:
    await play(dut, BurstCounter(*parameters(dut, "Words")), {"en": 1.0, "start": 0.3})
