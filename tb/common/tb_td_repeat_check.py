# SPDX-License-Identifier: Apache-2.0
"""td_repeat_check against its model in every clock: frames repeat, some with a flipped bit, some cut short."""

import random
from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.common.td_repeat_check import RepeatCheck
from tb.lockstep import Pins, play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Width")
STRUCTURES = (
    built(36, on=VERILATOR),
    built(21, on=ICARUS, mutants=ICARUS),
    built(192),
)
PROOFS = (Proof("words that fold", {"Width": 21}, steps=3),)
WORDS = 5  # of a frame


@cocotb.test
async def frames(dut: Any) -> None:
    (width,) = parameters(dut, "Width")
    chance = random.Random(cocotb.RANDOM_SEED)
    tables = [[chance.getrandbits(width) for _ in range(WORDS)] for _ in range(2)]

    def legal(core: RepeatCheck, pins: Pins) -> None:
        """Send frames of two tables that change at times; some have a flip, are short, or do not end."""
        if core.words is None and not pins["in_first"]:
            pins["in_valid"] = 0
        if pins["in_valid"]:
            if core.words is not None and chance.random() < 0.98:
                pins["in_first"] = 0
            if pins["in_first"]:
                bank = core.bank ^ (chance.random() < 0.1)
                pins["in_bank"] = bank
                if chance.random() < 0.05:
                    tables[bank] = [chance.getrandbits(width) * chance.randrange(2)] * WORDS
            place = 0 if pins["in_first"] or core.words is None else len(core.words)
            bank = pins["in_bank"] if pins["in_first"] else core.bank
            pins["in_last"] = place == WORDS - 1 or (place > 0 and chance.random() < 0.1)
            pins["in_data"] = tables[bank][place] ^ (chance.random() < 0.05) << chance.randrange(width)

    choices: dict[str, Any] = {"en": 1.0, "in_valid": 1.0, "in_first": 1.0, "in_last": 0.0, "in_bank": (0, 1)}
    await play(dut, RepeatCheck(), choices | {"in_data": (0,)}, legal)
