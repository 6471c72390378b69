# SPDX-License-Identifier: Apache-2.0
"""Two clocks of any ratio with jitter, for cores that pass words from one to the other."""

import random
from typing import Any

import cocotb
from cocotb.triggers import RisingEdge, Timer
from cocotb.utils import get_sim_time

from tb.pins import value

# Periods of source and sink in picoseconds: equal, in ratios of small integers, close to each other, and far apart.
RATIOS = {
    "equal": (10_000, 10_000),
    "twice": (10_000, 20_000),
    "half": (20_000, 10_000),
    "a_bit_slow": (10_000, 10_100),
    "a_bit_fast": (10_100, 10_000),
    "three_to_2": (15_000, 10_000),
    "two_to_3": (10_000, 15_000),
    "camera_24": (41_668, 10_000),
    "far_slower": (4_000, 74_000),
    "far_faster": (74_000, 4_000),
}
JITTER = 0.1  # of a period, in both directions


async def run_clock(pin: Any, period_ps: int, seed: int, jitter: float = JITTER) -> None:
    """Drive a clock for ever; both edges vary at random within the jitter."""
    chance = random.Random(f"{cocotb.RANDOM_SEED} {seed}")
    while True:
        for level in (0, 1):
            pin.value = level
            await Timer(round(period_ps / 2 * chance.uniform(1 - jitter, 1 + jitter)), "ps")


async def watch(clock: Any, pins: Any, events: Any, side: str) -> None:
    """Append (time in ps, side, values of the pins by name, before the edge) to `events` at each edge of a clock."""
    edge, reads = RisingEdge(clock), {pin._name: value(pin) for pin in pins}
    while True:
        await edge
        values = {name: read() for name, read in reads.items()}
        events.append((round(get_sim_time("ps")), side, values))
