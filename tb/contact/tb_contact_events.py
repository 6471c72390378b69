# SPDX-License-Identifier: Apache-2.0
"""contact_events against its model in every clock."""

import random
from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.contact.contact_events import EventsByClock, latency
from tactile_depth.chip.contact.threshold_comparator import above
from tactile_depth.chip.fixed_point import codes, joined
from tb.contact.beats import Frames, beats, levels
from tb.contact.tb_contact_peak import NAMES
from tb.lockstep import CLOCKS, WORD, Pins, play
from tb.stream import depth_position, parameters
from tb.structures import BOTH, ICARUS, VERILATOR, Mutants, of_parameters

FRAME_START = depth_position(True, False, False)

built = of_parameters(" ".join(NAMES))
STRUCTURES = (  # a frame has at least as many beats as its record takes cycles
    built(24, 5, 8, 1, 0, on=VERILATOR),
    built(6, 5, 8, 1, 1, on=ICARUS, mutants=BOTH),
    built(32, 5, 16, 1, 1),
    built(12, 9, 4, 1, 0),
    built(24, 8, 16, 1, 0),
    built(24, 5, 32, 4, 1),
    built(16, 10, 32, 8, 0),
    built(12, 4, 16, 2, 0),
)
PROTOCOL = {
    "depth_frames": {"Columns": "Columns / Lanes"},
    "counts": "live & ~reset",
    "m_event_tdata m_event_tlast": "counts & m_event_tvalid",
}
MUTANTS = Mutants(outside=("frame",), flat=False)
PROOFS = (
    Proof(
        "rows and columns are only counted; whatever count, peak, sums and centroid come out: these have proofs",
        {"Rows": 4, "Columns": 8, "Latency": latency(4, 8)},
        steps=2,
        free=("sums", "count", "peak", "middle", "late_position"),
    ),
)


@cocotb.test
async def records(dut: Any) -> None:
    chance, frames = random.Random(cocotb.RANDOM_SEED), Frames(dut)
    width, rows, columns, lanes, _ = given = parameters(dut, *NAMES)
    depths, lowest, signs = beats(width, lanes), 3 << width - 1, joined([1 << width - 1] * lanes, width)
    thresholds = levels(width, width + 1) * 10 + levels(width + 1, width + 1)
    settings: dict[str, list[int]] = dict.fromkeys(("on_threshold", "off_threshold", "area_threshold"), thresholds)
    powers = [1 << bit for bit in range(32)]
    settings["minimum_area"] = [*range(1, 9), 0, rows * columns, rows * columns + 1, *powers]
    settings["debounce"] = [1, 0, 2, 3, *powers[:8]]

    def legal(model: EventsByClock, pins: Pins) -> None:
        """Settings count with the first depths of a frame, marks with depths. Frames are full, sparse or negative, and
        as if many came before."""
        pins |= {pin: chance.choice((values[0], chance.choice(values))) for pin, values in settings.items()}
        if chance.random() < 0.3:
            half_peak = (model.events.last_peak or 0) >> 1
            pins["area_threshold"] = (half_peak ^ 1 << chance.randrange(width + 1)) % (2 << width)
        if chance.random() < 0.01 and not any(model.due):
            dut.frame.value = model.events.frames = (1 << chance.randrange(33)) - 1
        frames(model, pins)
        if chance.random() < (1, 0.3, 0.03)[model.events.frames % 3]:
            pins["in_data"] = chance.choice(depths)
        if model.events.frames % 16 < 4:
            pins |= {"in_data": pins["in_data"] | signs, "on_threshold": lowest, "off_threshold": lowest}
        of_frame = None if pins["in_position"] & FRAME_START else model.events.settings
        (on,) = [of_frame.on_threshold] if of_frame else codes(pins["on_threshold"], 1, width + 1)
        pins["in_above"] = above(codes(pins["in_data"], lanes, width), on)
        if not pins["in_valid"]:
            pins["in_position"] = chance.getrandbits(3)

    choices: dict[str, Any] = {
        "in_valid": 1.0,
        "interrupts": 0.02,
        "m_event_tready": 1.0,
        "in_time": WORD,
        "in_flags": WORD,
        "in_flipped": 0.3,
        "in_residual": 0.3,
    }
    await play(dut, EventsByClock(*given), {**choices, "in_data": depths}, legal, clocks=3 * CLOCKS)
