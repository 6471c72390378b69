# SPDX-License-Identifier: Apache-2.0
"""td_ramp against its model: every combination of extremes, random words, pauses."""

import itertools
import random
from typing import Any

import cocotb
import numpy as np

from formal.entries import Proof
from tactile_depth.chip.common.td_ramp import latency, ramp
from tb.stream import drive, parameters, parametrize
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Width StepWidth Count")
STRUCTURES = (
    built(32, 29, 8, on=VERILATOR),
    built(8, 8, 1, on=ICARUS),
    built(10, 6, 4, on=ICARUS, mutants=ICARUS),
    built(9, 5, 2),
    built(40, 37, 32),
)
REFUSED = {"Count_must_be_a_power_of_two": "Count=0, Count=3", "StepWidth_must_be_at_most_Width": "StepWidth=33"}
PROTOCOL = {"settled": {"Clocks": "$clog2(Count)"}, "counts": "settled"}
PROOFS = tuple(
    Proof("sums are exact at any width; no tree, and one of two levels", {"Count": count}) for count in (1, 4)
)


@cocotb.test()
@parametrize(pause=[0.0, 0.3])
async def ramps(dut: Any, pause: float) -> None:
    chance = random.Random(cocotb.RANDOM_SEED)
    width, step_width, count = parameters(dut, "Width", "StepWidth", "Count")
    largest, high = (1 << width) - 1, (1 << step_width - 1) - 1
    pairs = list(itertools.product((0, 1, largest >> 1, largest), (-high - 1, -1, 0, 1, high)))
    pairs += [(chance.randint(0, largest), chance.randint(-high - 1, high)) for _ in range(300)]
    clocks = latency(count)
    pins = await drive(dut, [{"first": a, "step": b} for a, b in [*pairs, *[(0, 0)] * clocks]], ["out"], pause)
    words = np.array(pairs, np.int64)
    expected = ramp(words[:, 0], words[:, 1], count, width)
    for index, want in enumerate(expected):
        word = int(pins["out"][index + clocks])
        got = [word >> width * n & largest for n in range(count)]
        assert got == want.tolist(), f"{pairs[index]}: {got}, not {want.tolist()}"
