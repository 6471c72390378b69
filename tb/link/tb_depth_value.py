# SPDX-License-Identifier: Apache-2.0
"""depth_value against tactile_depth.chip.link.depth_formats: every shift, ties, values that just clip, extremes."""

import random
from typing import Any

import cocotb
import numpy as np

from formal.entries import Proof
from tactile_depth.chip.link.depth_formats import DepthFormat, to_bytes
from tactile_depth.chip.link.packets import LARGEST_SHIFT
from tb.stream import MANY, drive, parameters, parametrize
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


LATENCY = 3


def codes_of(width: int, shift: int, count: int, chance: random.Random) -> list[int]:
    """Return the codes of a value: random ones, extremes, and sums near a tie or near the limits of 16 bits."""
    low, high = -(1 << width - 1), (1 << width - 1) - 1
    kind = chance.randrange(6)
    if kind == 0:
        return [chance.randint(low, high) for _ in range(count)]
    if kind == 1:
        return [chance.choice([low, high]) for _ in range(count)]
    if kind == 2:
        return [chance.choice([-1, 0, 1]) for _ in range(count)]
    if kind == 3:
        places = [chance.randrange(width) for _ in range(count)]
        return [min(max(chance.choice([-1, 1]) << place, low), high) for place in places]
    halves = chance.choice([-65537, -65536, -65535, 65533, 65534, 65535]) if kind == 4 else chance.randint(-9, 9)
    total = (halves * count << shift) // 2 + chance.choice([-1, 0, 0, 1])
    spread = chance.randint(-3, 3)
    codes = [total // count + spread, *[total // count] * (count - 2), total - (count - 1) * (total // count) - spread]
    return [min(max(code, low), high) for code in (codes if count > 1 else [total])]


@cocotb.test(timeout_time=20, timeout_unit="ms")
@parametrize(average=[False, True])
async def values(dut: Any, average: bool) -> None:
    """Send values of every shift, with gaps between their codes; between values the code is random."""
    (width,) = parameters(dut, "DataWidth")
    chance = random.Random(cocotb.RANDOM_SEED)
    inputs: list[dict[str, int]] = []
    due: list[tuple[range, int, list[int]]] = []  # clocks, shift and codes of each value
    for shift in range(LARGEST_SHIFT + 1):
        for _ in range(20 * MANY):
            codes = codes_of(width, shift, 4 if average else 1, chance)
            for index, code in enumerate(codes):
                idle = {"average": average, "shift": shift, "in_valid": 0, "in_first": chance.randrange(2)}
                while chance.random() < 0.2:
                    inputs.append(idle | {"in_code": chance.getrandbits(width)})
                taken = {"in_valid": 1, "in_first": int(index == 0), "in_code": code % (1 << width)}
                inputs.append(idle | taken)
            there = len(inputs) - 1 + LATENCY
            gap = {"average": average, "shift": shift, "in_valid": 0, "in_first": 1}
            inputs += [gap | {"in_code": chance.getrandbits(width)} for _ in range(LATENCY + chance.randrange(2))]
            due.append((range(there, len(inputs) + LATENCY - 1), shift, codes))
    seen = await drive(dut, [*inputs, *[inputs[-1]] * LATENCY], ["value"])
    for clocks, shift, codes in due:
        frame = np.array(codes, np.int32).reshape(-1, 2 if average else 1)
        wanted = to_bytes(frame, DepthFormat.AVERAGED if average else DepthFormat.SHORT, width, shift)
        for clock in clocks:  # it stands
            value = seen["value"][clock].to_signed()
            assert value == int.from_bytes(wanted, "little", signed=True), f"{codes}, shift {shift}: {value}"
