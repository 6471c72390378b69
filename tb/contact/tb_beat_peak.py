# SPDX-License-Identifier: Apache-2.0
"""beat_peak against its model, in every cycle."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import Proof
from tactile_depth.chip.contact.beat_peak import beat_peak, latency
from tb.stream import drive, parameters
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Width Lanes")
STRUCTURES = (
    built(24, 8, on=VERILATOR),
    built(6, 4, on=ICARUS, mutants=ICARUS),
    built(6, 2, on=ICARUS),
    built(32, 32),
    built(12, 16),
)


PROTOCOL = {"peak peak_offset": "any"}
PROOFS = (Proof("comparisons are exact at any width"),)


BEATS = 600


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
    pins = await drive(dut, [*stimuli, *[stimuli[-1]] * latency(lanes)], ["any", "peak", "peak_offset"])
    for index, (above, depths) in enumerate(sent):
        wanted = beat_peak(above, depths)
        at = index + latency(lanes)
        assert bool(pins["any"][at]) == (wanted is not None), f"any of beat {index}"
        if wanted is not None:
            assert (pins["peak"][at].to_signed(), int(pins["peak_offset"][at])) == wanted, f"peak of beat {index}"
