# SPDX-License-Identifier: Apache-2.0
"""frame_guard against its model in every clock."""

import random
from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.video.frame_guard import FrameGuard
from tb.lockstep import CLOCKS, WORD, Pins, play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, Mutants, of_parameters

built = of_parameters("Rows Columns")
STRUCTURES = (built(8, 2, on=VERILATOR), built(3, 4, on=ICARUS, mutants=ICARUS), built(4, 8))
PROTOCOL = {
    "counts": "live & ~reset",
    "out_valid out_frame_start out_frame_end": "counts & en",
    "out_data out_position": "counts & en & out_valid",
    "out_bad out_test": "counts & en & out_valid & out_frame_end",
}
MUTANTS = Mutants(outside=("silence",))
PROOFS = tuple(
    Proof(
        "rows and columns are only counted; a count that is no power of two, and one that is",
        {"Rows": rows, "Columns": columns},
    )
    for rows, columns in ((3, 4), (4, 2))
)


@cocotb.test
async def words(dut: Any) -> None:
    chance = random.Random(cocotb.RANDOM_SEED)
    pins = {"en": 1.0, "s_valid": 1.0, "s_data": WORD, "timeout": [5, 0, 1, 2, 8]}
    pins |= dict.fromkeys(("s_last", "s_user", "s_test"), 0.1)

    def legal(core: FrameGuard, pins: Pins) -> None:
        """Set each mark, wrong where the choice says so; a tenth of the starts is missing; some silences are long."""
        pins["s_user"] ^= not core.pixels and chance.random() < 0.9
        pins["s_last"] ^= len(core.pixels) % core.columns == core.columns - 1
        if core.silence and chance.random() < 0.5:
            if chance.getrandbits(1):
                bit = chance.randrange(32)
                core.silence = 1 << bit | chance.choice((0, chance.getrandbits(bit)))
                dut.silence.value = core.silence + 1
            pins |= {"s_valid": 0, "timeout": core.silence + 1 + (chance.random() < 0.7)}

    rows, columns = parameters(dut, "Rows", "Columns")
    await play(dut, FrameGuard(rows, columns), pins, legal, clocks=max(CLOCKS, 18_000))
