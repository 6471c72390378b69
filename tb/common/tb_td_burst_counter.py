# SPDX-License-Identifier: Apache-2.0
"""td_burst_counter against its model: bursts apart, back to back, begun again; pauses; reset."""

import random
from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.common.td_burst_counter import burst_counter
from tb.stream import drive, parameters, parametrize
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Words")
STRUCTURES = (
    built(16, on=VERILATOR),
    built(8, on=ICARUS, mutants=ICARUS),
    built(64),
)
REFUSED = {"Words_must_be_at_least_2": "Words=1"}
PROTOCOL = {"counts": "live", "position": "live & active"}
PROOFS = tuple(
    Proof(
        why,
        {"Words": words},
    )
    for words, why in ((2, "the smallest"), (8, "one counter, the same logic at every power of two"))
)


def starts(words: int, chance: random.Random) -> list[Any]:
    """Return `start` of each cycle: two bursts back to back, one apart, one restarted, random ones, silence."""
    burst = [1] + [0] * (words - 1)
    random_ones = [int(chance.random() < 2 / words) for _ in range(10 * words)]
    return [*burst, *burst, *[0] * 5, *burst, *burst[:3], *burst, *random_ones, *[0] * (words + 3)]


async def check(dut: Any, pause: float, before: int) -> None:
    """Send bursts after `before` cycles of another one and a reset, and compare the positions with the model."""
    (words,) = parameters(dut, "Words")
    chance = random.Random(cocotb.RANDOM_SEED)
    lost = [{"rst": 0, "start": int(n == 0)} for n in range(before)] + [{"rst": 1, "start": 0}]
    kept = [{"rst": 0, "start": start} for start in (0, *starts(words, chance))]
    pins = await drive(dut, [*lost, *kept], ["position", "active"], pause)
    begun = [bool(start) for start in pins["start"][len(lost) :]]
    pairs = zip(pins["position"][len(lost) :], pins["active"][len(lost) :], strict=True)
    got = [int(position) if active else None for position, active in pairs]
    assert got == burst_counter(begun, words)


@cocotb.test()
@parametrize(pause=[0.0, 0.3], before=[0, 2])
async def positions(dut: Any, pause: float, before: int) -> None:
    await check(dut, pause, before)
