# SPDX-License-Identifier: Apache-2.0
"""cobs_decode against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.link.cobs_decode import LONGEST_PIECE, CobsDecode
from tactile_depth.chip.link.framing import RUN
from tb.lockstep import CLOCKS, Pins, play
from tb.stream import parameters
from tb.structures import BOTH, ICARUS, VERILATOR, of_parameters

built = of_parameters("Longest")
STRUCTURES = (built(LONGEST_PIECE, on=VERILATOR), built(300, on=BOTH, mutants=BOTH), built(2, on=ICARUS))
PROTOCOL = {
    "holds": "~(in_valid & in_broken)",
    "counts": "live",
    "out_data": "live & out_valid",
    "out_bad": "live & out_end",
}
PROOFS = tuple(
    Proof("the length in use; one of which a trace shows a piece", {"Longest": longest}, steps=3)
    for longest in (LONGEST_PIECE, 5)
)


def legal(model: CobsDecode, pins: Pins) -> None:
    """End a piece at any place, or at the length wanted; no byte is valid and broken."""
    if pins.pop("ends") | (len(model.piece or ()) == pins.pop("length")):
        pins["in_data"] = 0
    pins["in_valid"] &= not pins["in_broken"]


@cocotb.test
async def pieces(dut: Any) -> None:
    (longest,) = parameters(dut, "Longest")
    codes = [1, RUN + 1, *(code ^ (1 << bit) for code in (0, RUN + 1) for bit in range(8))]
    lengths = [longest + 1, longest, *(1 << bit for bit in range(5, longest.bit_length()))]
    choices = {"in_valid": 1.0, "in_data": codes, "ends": 0.1, "length": lengths, "in_broken": 0.01}
    await play(dut, CobsDecode(longest), choices, legal, clocks=2 * CLOCKS)
