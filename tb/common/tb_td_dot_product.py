# SPDX-License-Identifier: Apache-2.0
"""td_dot_product against its model: every combination of extremes, random words, pauses."""

import itertools
import random
from typing import Any

import cocotb
import numpy as np

from formal.entries import Proof
from tactile_depth.chip.common.td_dot_product import LATENCY, dot_product
from tb.stream import drive, parameters, parametrize
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("AWidth BWidth")
STRUCTURES = (built(27, 18, on=VERILATOR), built(15, 10, on=ICARUS), built(35, 24), built(4, 3, mutants=ICARUS))
PROTOCOL = {"settled": {"Clocks": 4}, "counts": "settled"}
PROOFS = (Proof("no control but en; no width enters"),)


FACTORS = ("a0", "b0", "a1", "b1")


@cocotb.test()
@parametrize(pause=[0.0, 0.3])
async def products(dut: Any, pause: float) -> None:
    widths = parameters(dut, "AWidth", "BWidth") * 2
    chance = random.Random(cocotb.RANDOM_SEED)
    limits = [(-(1 << (width - 1)), 0, (1 << (width - 1)) - 1) for width in widths]
    operands = [*itertools.product(*limits)]
    operands += [tuple(chance.randint(low, high) for low, _, high in limits) for _ in range(300)]
    operands += [(0, 0, 0, 0)] * LATENCY
    pins = await drive(dut, [dict(zip(FACTORS, words, strict=True)) for words in operands], ["sum"], pause)
    factors = [np.array([word.to_signed() for word in pins[pin]]) for pin in FACTORS]
    got = [word.to_signed() for word in pins["sum"][LATENCY:]]
    np.testing.assert_array_equal(got, dot_product(*factors)[:-LATENCY])
