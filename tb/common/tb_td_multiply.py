# SPDX-License-Identifier: Apache-2.0
"""td_multiply against tactile_depth.chip.common.td_multiply: every combination of extremes, random words, pauses."""

import itertools
import random
from typing import Any

import cocotb
import numpy as np

from formal.entries import Proof
from tactile_depth.chip.common.td_multiply import LATENCY, multiply
from tb.stream import drive, parameters, parametrize
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("AWidth BWidth")
STRUCTURES = (built(27, 18, on=VERILATOR), built(35, 24, on=ICARUS), built(15, 10, mutants=ICARUS), built(2, 3))
PROTOCOL = {"settled": {}, "counts": "settled"}
PROOFS = (Proof("no control but en; no width enters"),)


@cocotb.test()
@parametrize(pause=[0.0, 0.3])
async def products(dut: Any, pause: float) -> None:
    chance = random.Random(cocotb.RANDOM_SEED)
    limits = [(-(1 << (width - 1)), (1 << (width - 1)) - 1) for width in parameters(dut, "AWidth", "BWidth")]
    operands = list(itertools.product(*((low, -1, 0, 1, high) for low, high in limits)))
    operands += [tuple(chance.randint(low, high) for low, high in limits) for _ in range(300)]
    operands += [(0, 0)] * LATENCY
    pins = await drive(dut, [{"a": a, "b": b} for a, b in operands], ["product"], pause)
    factors = [np.array([word.to_signed() for word in pins[pin]]) for pin in ("a", "b")]
    got = [word.to_signed() for word in pins["product"][LATENCY:]]
    np.testing.assert_array_equal(got, multiply(*factors)[:-LATENCY])
