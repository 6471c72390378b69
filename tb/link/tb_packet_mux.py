# SPDX-License-Identifier: Apache-2.0
"""packet_mux against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import FULL_WIDTH, Proof
from tactile_depth.chip.link.packet_mux import SOURCES, PacketMux
from tb.lockstep import WORD, play
from tb.structures import BOTH, ICARUS, Structure

STRUCTURES = (Structure(on=BOTH, mutants=ICARUS),)
PROTOCOL = {
    "stays": "status_ reply_ record_ depth_",
    "counts": "live & ~reset",
    "out_data out_last": "counts & out_valid",
}
PROOFS = (Proof(FULL_WIDTH),)


@cocotb.test()
async def packets(dut: Any) -> None:
    choices: dict[str, Any] = {"out_ready": 1.0}
    for name in SOURCES:
        choices |= {f"{name}_valid": 0.4, f"{name}_data": WORD, f"{name}_last": 1.0}
    await play(dut, PacketMux(), choices, offers=SOURCES)
