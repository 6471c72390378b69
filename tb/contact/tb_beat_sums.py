# SPDX-License-Identifier: Apache-2.0
"""beat_sums against its model, in every cycle."""

from dataclasses import asdict, fields
from typing import Any

import cocotb
import numpy as np

from tactile_depth.contact.beat_sums import BeatSums, beat_sums, latency
from tb.stream import drive, parameters

BEATS = 600
SIGNED = ("volume", "peak")


def beats(lanes: int, width: int) -> list[tuple[list[bool], list[int]]]:
    """Return random depths of every kind; some beats have few different values, so that peaks are equal."""
    rng = np.random.default_rng(cocotb.RANDOM_SEED)
    low, high = -(1 << width - 1), (1 << width - 1) - 1
    made = []
    for index in range(BEATS):
        share = rng.choice([0.0, 0.2, 0.5, 1.0])
        match index % 3:
            case 0:
                depths = rng.integers(low, high, lanes, endpoint=True)
            case 1:
                depths = rng.choice([low, high], lanes)
            case _:
                depths = rng.integers(-1, 2, lanes)
        made.append(((rng.random(lanes) < share).tolist(), depths.tolist()))
    return made


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def random_beats(dut: Any) -> None:
    lanes, width = parameters(dut, "Lanes", "Width")
    sent = beats(lanes, width)
    mask = (1 << width) - 1
    stimuli = [
        {
            "above": sum(bit << lane for lane, bit in enumerate(above)),
            "data": sum((depth & mask) << lane * width for lane, depth in enumerate(depths)),
        }
        for above, depths in sent
    ]
    names = [field.name for field in fields(BeatSums)]
    pins = await drive(dut, [*stimuli, *[stimuli[-1]] * latency(lanes)], names)
    for index, (above, depths) in enumerate(sent):
        wanted = beat_sums(above, depths)
        for name, value in asdict(wanted).items():
            if value is not None:
                pin = pins[name][index + latency(lanes)]
                have = pin.to_signed() if name in SIGNED else int(pin)
                assert have == value, f"{name} of beat {index}: {have}, the model says {value}"
