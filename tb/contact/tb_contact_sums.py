# SPDX-License-Identifier: Apache-2.0
"""contact_sums against its model in every clock."""

from typing import Any

import cocotb

from tactile_depth.chip.contact.contact_sums import SumsByClock
from tactile_depth.chip.fixed_point import joined
from tb.contact.beats import Frames, beats, levels
from tb.contact.tb_contact_peak import NAMES, proofs, structures
from tb.lockstep import CLOCKS, Pins, play
from tb.stream import parameters

STRUCTURES = structures(8)
PROTOCOL = {"depth_frames": {"Columns": "Columns / Lanes"}, "counts": "live & ~reset", "sums": "counts & sums_valid"}
PROOFS = proofs(
    "positions are only counted; sums are exact at any width; either order of rows; the sums of a beat of "
    "several depths are proven of beat_sums"
)


@cocotb.test
async def sums(dut: Any) -> None:
    width, lanes = parameters(dut, "Width", "Lanes")
    lowest, highest = (joined([code] * lanes, width) for code in (-1 << width - 1, ~(-1 << width - 1)))
    frames = Frames(dut)

    def legal(model: SumsByClock, pins: Pins) -> None:
        frames(model, pins)
        above = pins.pop("above")
        if pins.pop("sparse") and not above:
            pins["in_data"] = lowest

    bits = {"in_valid": 1.0, "interrupts": 0.02, "above": 0.2}
    thresholds = [1 << width - 1, *levels(width, width)]
    choices: dict[str, Any] = {
        **bits,
        "sparse": [0, 1, 1],
        "threshold": thresholds,
        "in_data": [highest, *beats(width, lanes)],
    }
    await play(dut, SumsByClock(*parameters(dut, *NAMES)), choices, legal, clocks=2 * CLOCKS)
