# SPDX-License-Identifier: Apache-2.0
"""td_axis_skid against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.common.td_axis_skid import AxisSkid
from tb.lockstep import WORD, play
from tb.structures import BOTH, ICARUS, Structure

STRUCTURES = (Structure({"Width": 26}, on=BOTH, mutants=ICARUS),)
PROTOCOL = {"counts": "live", "m_data": "live & m_valid"}
PROOFS = (Proof(WORD_FREE),)


@cocotb.test()
async def words(dut: Any) -> None:
    await play(dut, AxisSkid(), {"s_valid": 1.0, "s_data": WORD, "m_ready": 1.0})
