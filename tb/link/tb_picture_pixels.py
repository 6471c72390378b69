# SPDX-License-Identifier: Apache-2.0
"""picture_pixels against its model in every clock."""

import random
from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.link.picture_pixels import HEADER, PicturePixels
from tb.lockstep import WORD, Pins, play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, Mutants, of_parameters

built = of_parameters("Rows Columns")
STRUCTURES = (built(12, 16, on=VERILATOR), built(3, 4, on=ICARUS, mutants=ICARUS), built(5, 6), built(2, 300))
PROTOCOL = {
    "stays": "picture_",
    "counts": "live & ~reset",
    "m_axis_tdata m_axis_tlast m_axis_tuser": "counts & m_axis_tvalid",
}
MUTANTS = Mutants(repeats=4)
PROOFS = (Proof("rows and columns are only counted", {"Rows": 2, "Columns": 3}),)


@cocotb.test()
async def packets(dut: Any) -> None:
    rows, columns = parameters(dut, "Rows", "Columns")
    chance, header, waits = random.Random(cocotb.RANDOM_SEED), b"", False
    pins = {"picture_valid": 1.0, "picture_data": WORD, "picture_last": 0.2, "m_axis_tready": 1.0}

    def any_header(core: PicturePixels) -> bytes:
        """Return a header that begins a picture or goes on with it, but for one bit of some."""
        number, place = core.number, core.place
        if chance.random() < (0.7 if place == core.size else 1 / core.size):
            number, place = chance.choice((0, (1 << 32) - 1, chance.getrandbits(32))), 0
        good = int.from_bytes(HEADER.pack(number, *divmod(place, columns)), "little")
        return (good ^ (chance.random() < 0.3) << chance.randrange(64)).to_bytes(HEADER.size, "little")

    def legal(core: PicturePixels, pins: Pins) -> None:
        nonlocal header, waits
        if pins["picture_valid"] and not waits and len(core.packet) < HEADER.size:
            header = header if core.packet else any_header(core)
            pins["picture_data"] = header[len(core.packet)]
        waits = bool(pins["picture_valid"] and core.out and not pins["rst"])

    await play(dut, PicturePixels(rows, columns), pins, legal, offers=["picture"])
