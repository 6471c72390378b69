# SPDX-License-Identifier: Apache-2.0
"""bank_choice against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.link.bank_choice import BankChoice
from tb.lockstep import Pins, play
from tb.structures import BOTH, ICARUS, Structure

STRUCTURES = (Structure(on=BOTH, mutants=ICARUS),)
PROOFS = (Proof("it has no size; frames are numbered modulo 8, and at most three are inside"),)


def legal(banks: BankChoice, pins: Pins) -> None:
    """End a frame that is written, take the one that waits when none is read, and be done with that."""
    pins["write_end"] &= banks.written is not None
    pins["write_begin"] &= not pins["write_end"]
    pins["done"] &= banks.read is not None
    pins["take"] &= banks.ready is not None and pins["keep"] and (banks.read is None or pins["done"])


@cocotb.test()
async def banks(dut: Any) -> None:
    choices = dict.fromkeys(("keep", "write_begin", "write_end", "publish", "take", "done"), 1.0)
    await play(dut, BankChoice(), choices, legal)
