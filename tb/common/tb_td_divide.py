# SPDX-License-Identifier: Apache-2.0
"""td_divide against its model: corners, random operands, back to back, apart, abandoned and reset."""

import itertools
import random
from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.common import td_divide
from tactile_depth.chip.common.td_divide import cycles, divide
from tb.stream import drive, parameters
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("DivisorWidth QuotientWidth")
STRUCTURES = (
    built(24, 25, on=VERILATOR),
    built(6, 5, on=ICARUS, mutants=ICARUS),
    built(3, 9, on=ICARUS),
    built(1, 2),
    built(15, 12),
)
REFUSED = {"DivisorWidth_must_be_at_least_1_and_QuotientWidth_at_least_2": "DivisorWidth=0, QuotientWidth=1"}
PROOFS = tuple(
    Proof(why, {"DivisorWidth": width, "QuotientWidth": bits, "Latency": td_divide.cycles(bits)}, steps)
    for width, bits, steps, why in (
        (3, 4, 0, "every numerator and divisor; a bit is found in the same way at any width"),
        (2, 25, 34, "the longest quotient in use: its counter in full"),
    )
)


def operands(divisor_width: int, quotient_width: int) -> list[tuple[int, int]]:
    """Return numerators and divisors: at their limits, at the edge of an overflow, exact ones, and random ones of any
    size."""
    chance = random.Random(cocotb.RANDOM_SEED)
    top = (1 << divisor_width) - 1
    largest = (1 << divisor_width + quotient_width) - 1
    pairs = list(itertools.product({0, 1, largest - 1, largest, top, top << quotient_width}, {0, 1, top}))
    for _ in range(100):
        divisor = chance.getrandbits(chance.randint(1, divisor_width))
        edge = divisor << quotient_width
        numerators = [edge - 1, edge, edge - divisor, chance.getrandbits(chance.randint(1, quotient_width)) * divisor]
        numerators += [chance.randrange(max(edge, 1)), chance.getrandbits(divisor_width + quotient_width)]
        pairs += [(min(max(numerator, 0), largest), divisor) for numerator in numerators]
    return pairs


@cocotb.test()
async def quotients(dut: Any) -> None:
    """Check that each `done` comes at its latency after the last start with the results of the model, and none after a
    reset."""
    divisor_width, quotient_width = parameters(dut, "DivisorWidth", "QuotientWidth")
    chance = random.Random(cocotb.RANDOM_SEED + 1)
    latency = cycles(quotient_width)
    stimuli: list[dict[str, int]] = []
    for numerator, divisor in [*operands(divisor_width, quotient_width), (0, 1)]:
        # The next division starts with `done` or later, or a start or a reset ends this one early.
        pause = chance.choice([1, 2, 3 * latency])  # long enough for any counter of bits to wrap
        length = chance.choice([latency, latency, latency + pause, chance.randint(1, latency)])
        reset = chance.randrange(length) if chance.random() < 0.1 else None
        for clock in range(length):
            noise = chance.getrandbits(divisor_width + quotient_width)
            stimuli.append(
                {
                    "rst": clock == reset and clock > 0,
                    "start": clock == 0,
                    "numerator": noise if clock else numerator,
                    "divisor": divisor if clock <= latency else chance.getrandbits(divisor_width),
                }
            )
    stimuli += [{"rst": 0, "start": 0, "numerator": 0, "divisor": 1}] * latency
    pins = await drive(dut, stimuli, ["done", "quotient", "remainder", "overflow"])
    due: dict[int, tuple[int, int]] = {}
    finished = 0
    for clock, inputs in enumerate(stimuli):
        expected = due.pop(clock, None)
        assert bool(pins["done"][clock]) == (expected is not None), f"done in clock {clock}"
        if expected is not None:
            finished += 1
            result = divide(*expected, quotient_width)
            assert bool(pins["overflow"][clock]) == (result is None), f"overflow of {expected}"
            if result is not None:
                assert (int(pins["quotient"][clock]), int(pins["remainder"][clock])) == result, expected
        if inputs["rst"] or inputs["start"]:
            due.clear()
        if inputs["start"] and not inputs["rst"]:
            due[clock + latency] = inputs["numerator"], inputs["divisor"]
    assert finished > 300
