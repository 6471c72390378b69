# SPDX-License-Identifier: Apache-2.0
"""axil_port against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import FULL_WIDTH, Proof
from tactile_depth.chip.registers.axil_port import AxilPort
from tb.axil import CLIENT
from tb.lockstep import WORD, play
from tb.registers.bus import CHANNELS, PINS
from tb.structures import BOTH, ICARUS, Structure

STRUCTURES = (Structure(on=BOTH, mutants=ICARUS),)
PROTOCOL = CLIENT | {"counts": "live"}
PROOFS = (Proof(FULL_WIDTH),)


@cocotb.test
async def transactions(dut: Any) -> None:
    answers: dict[str, Any] = {"read_data": WORD, "late_data": WORD}
    answers |= dict.fromkeys(("write_refused", "read_refused", "read_late", "late_refused"), 0.6)
    await play(dut, AxilPort(), PINS | answers, offers=CHANNELS)
