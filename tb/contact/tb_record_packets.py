# SPDX-License-Identifier: Apache-2.0
"""record_packets against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.contact.record_packets import RecordPackets
from tb.lockstep import WORD, play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Words")
STRUCTURES = (built(13, on=VERILATOR), built(3, on=ICARUS, mutants=ICARUS), built(2))
PROTOCOL = {"counts": "live & ~reset", "m_event_tdata m_event_tlast": "counts & m_event_tvalid"}
PROOFS = (Proof("words are sent alike; as many to a packet as in use"),)


@cocotb.test()
async def records(dut: Any) -> None:
    choices = {"new_valid": 0.4, "new_record": WORD, "m_event_tready": 1.0}
    await play(dut, RecordPackets(*parameters(dut, "Words")), choices)
