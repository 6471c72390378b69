# SPDX-License-Identifier: Apache-2.0
"""depth_value against its model in every clock: every shift, ties, values that just clip, extremes."""

import random
from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.link.depth_value import DepthValue
from tactile_depth.chip.link.packets import LARGEST_SHIFT
from tb.lockstep import WORD, Pins, play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, Mutants, of_parameters

built = of_parameters("DataWidth")
STRUCTURES = (built(24, on=VERILATOR, mutants=ICARUS), built(12, on=ICARUS), built(32, on=ICARUS), built(16), built(2))
MUTANTS = Mutants(repeats=4)
PROOFS = (
    Proof(
        "the sum and the rounding are one formula for every width; 20 bits are rounded with every shift, and clip",
        {"DataWidth": 20},
        steps=6,
    ),
)


@cocotb.test()
async def values(dut: Any) -> None:
    (width,) = parameters(dut, "DataWidth")
    chance, halves = random.Random(cocotb.RANDOM_SEED), (*range(-9, 10), 65533, 65535, -65537)

    def legal(model: DepthValue, pins: Pins) -> None:
        """Half of the codes are at a tie, just below one, or a bit of the fraction above."""
        if chance.random() < 0.5:
            fraction = pins["shift"] + 2 * pins["average"]
            beside = chance.choice((0, -1, 1 << chance.randrange(fraction + 1)))
            pins["in_code"] = ((chance.choice(halves) << fraction >> 1) + beside) % (1 << width)

    bits = {"average": 1.0, "in_valid": 1.0, "in_first": 1.0}
    shifts = (LARGEST_SHIFT, *range(LARGEST_SHIFT + 1))
    await play(dut, DepthValue(width), {**bits, "shift": shifts, "in_code": WORD}, legal)
