# SPDX-License-Identifier: Apache-2.0
"""td_enable against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.common.td_enable import Enable
from tb.lockstep import play
from tb.structures import BOTH, ICARUS, Structure

STRUCTURES = (Structure({}, on=BOTH, mutants=ICARUS),)
PROTOCOL = {"counts": "live"}
PROOFS = (Proof("every structure"),)


@cocotb.test()
async def words(dut: Any) -> None:
    await play(dut, Enable(), {"en_next": 1.0})
