# SPDX-License-Identifier: Apache-2.0
"""contact_peak against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.contact.contact_peak import PeakByClock
from tactile_depth.chip.contact.threshold_comparator import above
from tactile_depth.chip.fixed_point import codes
from tb.contact.beats import Frames, beats, levels
from tb.lockstep import CLOCKS, Pins, play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, Structure, of_parameters

NAMES = ("Width", "Rows", "Columns", "Lanes", "BottomFirst")
built = of_parameters(" ".join(NAMES))


def structures(columns: int) -> tuple[Structure, ...]:
    """Return the structures of a core that measures frames, with the columns of the first one that has mutants."""
    return (
        built(24, 5, 8, 1, 0, on=VERILATOR),
        built(6, 5, columns, 1, 1, on=ICARUS, mutants=ICARUS),
        built(6, 5, 8, 4, 1, on=ICARUS, mutants=ICARUS),
        built(6, 5, 8, 1, 0),
        built(32, 5, 16, 1, 1),
        built(12, 9, 4, 1, 0),
        built(24, 5, 16, 2, 0),
        built(12, 3, 128, 64, 1),
        built(32, 5, 16, 8, 1),
    )


def proofs(bounds: str) -> tuple[Proof, ...]:
    """Return the proofs of such a core, for both orders of rows, and for one and two depths per beat."""
    return tuple(
        Proof(bounds, {"BottomFirst": bottom_first, "Columns": columns, "Lanes": lanes})
        for bottom_first, columns, lanes in ((0, 3, 1), (1, 3, 1), (0, 4, 2), (1, 4, 2))
    )


STRUCTURES = structures(7)
PROTOCOL = {
    "depth_frames": {"Columns": "Columns / Lanes"},
    "counts": "live & ~reset",
    "count": "counts & count_valid",
    "any_above peak peak_row peak_column": "counts & peak_valid",
}
PROOFS = proofs(
    "positions are only counted; either order of rows; the peak of a beat of several depths is proven of beat_peak"
)


@cocotb.test
async def peaks(dut: Any) -> None:
    width, lanes = parameters(dut, "Width", "Lanes")
    bits = {"in_valid": 1.0, "interrupts": 0.02, "touching": 1.0}
    thresholds = dict.fromkeys(("on_threshold", "off_threshold"), levels(width, width + 1))
    model, frames = PeakByClock(*parameters(dut, *NAMES)), Frames(dut)

    def legal(model: PeakByClock, pins: Pins) -> None:
        frames(model, pins)
        (on,) = codes(pins.pop("on_threshold"), 1, width + 1)
        pins["in_above"] = above(codes(pins["in_data"], lanes, width), on)

    await play(dut, model, {**bits, **thresholds, "in_data": beats(width, lanes)}, legal, clocks=3 * CLOCKS)
