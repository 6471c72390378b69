# SPDX-License-Identifier: Apache-2.0
"""centroid against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import ROUNDING, Proof
from tactile_depth.chip.contact import centroid
from tactile_depth.chip.contact.centroid import Centroid
from tb.lockstep import CLOCKS, WORD, Pins, play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("PositionWidth WeightWidth")
STRUCTURES = (
    built(7, 38, on=VERILATOR),
    built(3, 6, on=ICARUS, mutants=ICARUS),
    built(10, 52),
    built(2, 4),
    built(5, 9),
)
PROOFS = (
    Proof(
        f"every weight and moment of this width; a bit is found in the same way at any width; {ROUNDING}",
        {"Latency": centroid.cycles(2)},
    ),
)


def legal(model: Centroid, pins: Pins) -> None:
    """Hold what is held from a start on, which seldom comes before `done`; its moments are often near a tie."""
    near, restarts = pins.pop("near"), pins.pop("restarts")
    if model.left > 1:
        pins["start"] &= restarts
        if not pins["start"]:
            pins |= model.held
    if pins["start"]:
        weight = pins["weight"] = pins["weight"] or 1
        largest = weight * ((1 << model.bits) - 1)
        for name in ("column_moment", "row_moment"):
            moment = pins[name] % (largest + 1)
            if near:
                moment = weight * (pins[name] % (32 << model.bits)) // 32 + pins[name] % 3 - 1
            pins[name] = min(max(moment, 0), largest)


@cocotb.test()
async def means(dut: Any) -> None:
    (position_bits,) = parameters(dut, "PositionWidth")
    choices = {"start": 1.0, "restarts": 0.1, "near": 1.0, "column_moment": WORD, "row_moment": WORD, "weight": WORD}
    await play(dut, Centroid(position_bits), choices, legal, clocks=3 * CLOCKS)
