# SPDX-License-Identifier: Apache-2.0
"""beat_sums against its model, in every cycle."""

from dataclasses import asdict, fields
from typing import Any

import cocotb
import numpy as np

from formal.entries import Proof
from tactile_depth.chip.contact.beat_sums import BeatSums, beat_sums, latency
from tb.contact.tb_beat_peak import STRUCTURES as STRUCTURES
from tb.stream import drive, parameters

PROOFS = (Proof("sums are exact at any width"),)


BEATS = 600


def beats(lanes: int, width: int) -> list[tuple[list[bool], list[int]]]:
    """Return beats of random and of the largest weights, few to all of them above."""
    rng = np.random.default_rng(cocotb.RANDOM_SEED)
    largest = (1 << width) - 1
    made = []
    for index in range(BEATS):
        above = rng.random(lanes) < rng.choice([0.0, 0.2, 0.5, 1.0])
        weights = rng.integers(1, largest, lanes, endpoint=True) if index % 2 else rng.choice([1, largest], lanes)
        made.append((above.tolist(), np.where(above, weights, 0).tolist()))
    return made


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def random_beats(dut: Any) -> None:
    lanes, width = parameters(dut, "Lanes", "Width")
    sent = beats(lanes, width)
    stimuli = [
        {
            "above": sum(bit << lane for lane, bit in enumerate(above)),
            "weights": sum(weight << lane * width for lane, weight in enumerate(weights)),
        }
        for above, weights in sent
    ]
    names = [field.name for field in fields(BeatSums)]
    pins = await drive(dut, [*stimuli, *[stimuli[-1]] * latency(lanes)], names)
    for index, beat in enumerate(sent):
        wanted = beat_sums(*beat)
        for name, value in asdict(wanted).items():
            if value is not None:
                have = int(pins[name][index + latency(lanes)])
                assert have == value, f"{name} of beat {index}: {have}, the model says {value}"
