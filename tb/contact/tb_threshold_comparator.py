# SPDX-License-Identifier: Apache-2.0
"""threshold_comparator against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import FULL_WIDTH, Proof
from tactile_depth.chip.contact.threshold_comparator import ThresholdComparator
from tactile_depth.chip.fixed_point import codes, joined
from tb.contact.beats import beats, levels
from tb.lockstep import CLOCKS, Pins, play
from tb.stream import parameters
from tb.structures import BOTH, ICARUS, VERILATOR, of_parameters

built = of_parameters("Width Lanes")
STRUCTURES = (
    built(12, 1, on=BOTH, mutants=ICARUS),
    built(32, 1, on=VERILATOR),
    built(12, 4, on=ICARUS, mutants=ICARUS),
    built(24, 32),
    built(32, 2),
)
PROTOCOL = {
    "begun": {"begins": "in_valid & in_frame_start"},
    "holds": "rst | ~in_valid | begun | in_frame_start",
    "counts": "live & ~reset",
}
PROOFS = tuple(
    Proof(
        f"{FULL_WIDTH}; of several depths, which are only compared, any one decides", {"Width": width, "Lanes": lanes}
    )
    for width, lanes in ((24, 1), (4, 2))
)


def legal(model: ThresholdComparator, pins: Pins) -> None:
    """Begin a frame with the first beat of all; the only high depth of a beat is often near the threshold."""
    pins["in_frame_start"] |= model.threshold is None
    beside, lane, width = pins.pop("beside"), pins.pop("lane"), model.width
    lowest = -1 << width - 1
    depth = beside + (codes(pins["threshold"], 1, width + 1)[0] if pins["in_frame_start"] else model.threshold or 0)
    if beside < 2 and lowest <= depth < -lowest:
        others = [lowest] * model.lanes
        others[lane] = depth
        pins["in_data"] = joined(others, width)


@cocotb.test()
async def depths(dut: Any) -> None:
    width, lanes = parameters(dut, "Width", "Lanes")
    data = beats(width, lanes)
    near = [depth % (2 << width) for beat in data for depth in codes(beat, lanes, width)]
    choices = {
        "in_valid": 1.0,
        "in_frame_start": 0.4,
        "hold": 1.0,
        "threshold": [*near, *levels(width + 1, width + 1)],
        "in_data": data,
        "beside": [2, -1, 0, 1],
        "lane": range(lanes),
    }
    await play(dut, ThresholdComparator(width=width, lanes=lanes), choices, legal, clocks=3 * CLOCKS)
