# SPDX-License-Identifier: Apache-2.0
"""block_weights against its model: axes of any length, pauses between pixels, en low."""

import random
from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.camera.block_weights import block_weights
from tb.stream import drive, parameters, parametrize
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Numerator Denominator")
STRUCTURES = (
    built(15, 4, on=VERILATOR),
    built(1, 1, on=ICARUS),
    built(7, 5, on=ICARUS, mutants=ICARUS),
    built(8, 1, on=ICARUS, mutants=ICARUS),
    built(2, 1),
    built(3, 2),
    built(127, 16),
    built(4, 3),
)
PROTOCOL = {"begun": {"begins": "en & step & restart", "reset": "1'b0"}, "counts": "begun | restart"}
PROOFS = tuple(
    Proof(
        "one counter; ratios of 1, of an integer, below and above 2",
        {"Numerator": numerator, "Denominator": denominator},
    )
    for numerator, denominator in ((1, 1), (3, 1), (4, 3), (15, 4))
)


LONGEST = 60  # pixels of an axis
AXES = 20


@cocotb.test()
@parametrize(pause=[0.0, 0.4])
async def axes(dut: Any, pause: float) -> None:
    weights, ends = block_weights(LONGEST, *parameters(dut, "Numerator", "Denominator"))
    chance = random.Random(cocotb.RANDOM_SEED)
    stimuli = []
    for _ in range(AXES):
        axis = [{"step": int(chance.random() < 0.7), "restart": 0} for _ in range(chance.randrange(LONGEST))]
        stimuli += [{"step": 0, "restart": int(chance.random() < 0.5)}, {"step": 1, "restart": 1}, *axis]
    del stimuli[0]
    pins = await drive(dut, stimuli, ["weight", "block_ends"], pause)
    place = 0  # position of the pixel that is taken next
    for clock in range(len(stimuli)):
        present = 0 if pins["restart"][clock] else place
        got = int(pins["weight"][clock]), bool(pins["block_ends"][clock])
        assert got == (weights[present], ends[present]), f"clock {clock}, pixel {present}"
        if pins["step"][clock]:
            place = present + 1
