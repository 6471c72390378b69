# SPDX-License-Identifier: Apache-2.0
"""round_divide against its model: ties and their neighbours, limits, negative and too large totals, pauses."""

import random
from typing import Any

import cocotb
import numpy as np

from formal.entries import Proof
from tactile_depth.chip.camera.round_divide import LATENCY, round_divide
from tb.stream import MANY, drive, parameters, parametrize
from tb.structures import BOTH, ICARUS, Mutants, of_parameters

built = of_parameters("TotalWidth WeightWidth Drop")
STRUCTURES = (
    built(36, 8, 14, on=BOTH),
    built(12, 1, 2, on=ICARUS),
    built(17, 7, 2, on=ICARUS, mutants=ICARUS),
    built(20, 3, 4),
    built(50, 25, 16),
)
PROTOCOL = {"holds": "weight != '0", "settled": {"Clocks": 10}, "counts": "settled"}
MUTANTS = Mutants(repeats=2)
PROOFS = (
    Proof(
        "a stage for each bit of the quotient, the same at every width of the divisor",
        {"TotalWidth": 13, "WeightWidth": 2, "Drop": 3},
    ),
)


@cocotb.test
@parametrize(pause=[0.0, 0.3])
async def means(dut: Any, pause: float) -> None:
    total_width, weight_width, drop = parameters(dut, "TotalWidth", "WeightWidth", "Drop")
    chance = random.Random(cocotb.RANDOM_SEED)
    low, high = -(1 << (total_width - 1)), (1 << (total_width - 1)) - 1
    heaviest = (1 << weight_width) - 1
    weights = [1, heaviest, max(heaviest - 1, 1), *(chance.randint(1, heaviest) for _ in range(40 * MANY))]
    operands = [(total, weight) for weight in weights[:3] for total in (low, -1, 0, 1, high)]
    for weight in weights:
        divisor = weight << drop
        for mean in (0, 1, 254, 255, 256, chance.randrange(256)):
            for beside in (-1, 0, 1):
                operands.append((mean * divisor + beside, weight))
                operands.append((mean * divisor + divisor // 2 + beside, weight))
        operands.append((chance.randint(-2 * divisor, 300 * divisor), weight))
    stimuli = [{"total": total, "weight": weight} for total, weight in operands if low <= total <= high]
    stimuli += [{"total": 0, "weight": 1}] * LATENCY
    pins = await drive(dut, stimuli, ["mean"], pause)
    totals = np.array([word.to_signed() for word in pins["total"]])
    divisors = np.array([int(word) for word in pins["weight"]])
    got = [int(word) for word in pins["mean"][LATENCY:]]
    np.testing.assert_array_equal(got, round_divide(totals, divisors, drop)[:-LATENCY])
