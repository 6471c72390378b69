# SPDX-License-Identifier: Apache-2.0
"""packet_store against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.link.framing import LONGEST_BODY
from tactile_depth.chip.link.packet_store import PacketStore
from tb.lockstep import CLOCKS, WORD, Pins, play
from tb.stream import parameters
from tb.structures import BOTH, ICARUS, VERILATOR, of_parameters

built = of_parameters("BankBytes")
STRUCTURES = (built(1024, on=VERILATOR), built(8, on=ICARUS, mutants=BOTH), built(4))
PROOFS = tuple(
    Proof(
        "any place of 8 bits, wider ones count alike; a full bank in a trace; any byte is followed",
        {"BankBytes": size},
        steps=3,
    )
    for size in (256, 4)
)


def legal(model: PacketStore, pins: Pins) -> None:
    """End a packet behind its last byte; a good one is neither empty nor too long."""
    pins["in_end"] |= len(model.packet) == LONGEST_BODY
    pins["in_valid"] &= not pins["in_end"]
    pins["in_good"] &= bool(model.packet)


@cocotb.test
@cocotb.parametrize(ends=[0.2, 0.003])
async def packets(dut: Any, ends: float) -> None:
    choices = {"rst": ends / 20, "in_valid": 1.0, "in_data": WORD, "in_end": ends, "in_good": 1.0, "out_ready": 1.0}
    choices["out_drop"] = ends / 2
    await play(dut, PacketStore(*parameters(dut, "BankBytes")), choices, legal, clocks=2 * CLOCKS)
