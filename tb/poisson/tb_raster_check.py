# SPDX-License-Identifier: Apache-2.0
"""raster_check against its model in every clock; most positions are those of the raster, some have a flipped bit."""

import random
from typing import Any

import cocotb

from formal.entries import Proof
from tactile_depth.chip.poisson.raster_check import RasterCheck, place
from tb.lockstep import play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Rows Columns")
STRUCTURES = (
    built(6, 8, on=VERILATOR, mutants=VERILATOR),
    built(2, 2, on=ICARUS, mutants=ICARUS),
    built(3, 5, on=VERILATOR, mutants=VERILATOR),
    built(96, 128),
)
PROTOCOL = {"in_valid": "live"}
PROOFS = (
    Proof("counts that fill their bits", {"Rows": 4, "Columns": 8}),
    Proof("counts that do not", {"Rows": 3, "Columns": 5}),
)


@cocotb.test
async def rasters(dut: Any) -> None:
    chance, (rows, columns) = random.Random(cocotb.RANDOM_SEED), parameters(dut, "Rows", "Columns")

    def positions(core: RasterCheck, pins: dict[str, int]) -> None:
        """Let frames be whole, but for a flipped bit at times, and starts of frames."""
        if chance.random() < 0.98:
            pins["in_position"] = place(core.due, rows, columns)
            if chance.random() < 0.02:
                pins["in_position"] ^= 1 << chance.randrange(4)

    await play(dut, RasterCheck(rows, columns), {"en": 1.0, "in_valid": 1.0, "in_position": range(16)}, positions)
