# SPDX-License-Identifier: Apache-2.0
"""bank_choice against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.link.bank_choice import BankChoice
from tb.lockstep import Pins, play
from tb.structures import BOTH, Structure

STRUCTURES = (Structure(on=BOTH, mutants=True),)
PROOFS = (
    Proof(
        "never the bank that is read is written; the frame that is taken is the newest that became ready, whole; each "
        "frame is taken, waits, or is lost and counted once; without a reader none is lost before it is ready",
        "it has no size; frames are numbered modulo 8, and at most three are inside",
        depth=20,
    ),
)


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
