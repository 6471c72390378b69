# SPDX-License-Identifier: Apache-2.0
"""td_hold_check against its model in every clock: words that stay until others come, some with flipped bits."""

import random
from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.common.td_hold_check import HoldCheck
from tb.lockstep import WORD, Pins, play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Width")
STRUCTURES = (
    built(48, on=VERILATOR),
    built(5, on=ICARUS, mutants=ICARUS),
)
PROTOCOL = {"counts": "live"}
PROOFS = (Proof("any word", {"Width": 5}),)


@cocotb.test
async def words(dut: Any) -> None:
    (width,) = parameters(dut, "Width")
    chance = random.Random(cocotb.RANDOM_SEED)

    def flips(core: HoldCheck, pins: Pins) -> None:
        """Let most words stay as they are, with a bit or two flipped at times."""
        if not core.is_new and core.held is not None:
            pins["word"] = core.held
            for _ in range(chance.choice((0, 0, 1, 2))):
                pins["word"] ^= 1 << chance.randrange(width)

    await play(dut, HoldCheck(), {"rst": 0.02, "comes": 0.2, "word": WORD}, flips)
