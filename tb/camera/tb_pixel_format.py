# SPDX-License-Identifier: Apache-2.0
"""pixel_format against its model in every clock."""

import random
from typing import Any

import cocotb

from formal.entries import FULL_WIDTH, Proof
from tactile_depth.chip.camera.pixel_format import PixelFormat, pixel_format_parameters
from tactile_depth.chip.camera_configuration import FORMATS, PHASES, CameraConfiguration
from tb.lockstep import WORD, Pins, play
from tb.settings import RUN
from tb.structures import BOTH, ICARUS, VERILATOR, Mutants, Structure

PICTURE, GRID = (96, 64), (2, 2)
RAW = [name for name, form in FORMATS.items() if form.bayer]


def built(form: str, phase: int, **runs: Any) -> Structure:
    arguments: dict[str, Any] = {"picture": PICTURE, "grid": GRID, "pixel_format": form, "phase": PHASES[phase]}
    camera = CameraConfiguration(**arguments)
    return Structure(pixel_format_parameters(camera), device={"camera": arguments}, **runs)


STRUCTURES = (
    built("yuyv", 0, on=BOTH, mutants=ICARUS),
    built("raw10", 1, on=VERILATOR),
    built("raw10_lsb", 2, on=ICARUS, mutants=ICARUS),
    built("rgb565_bytes", 0, on=ICARUS, mutants=ICARUS),
    built("rgb888", 0, on=ICARUS),
    built("rgb565", 0),
    built("yuyv_bytes", 0),
    built("raw8", 3),
    built("raw12_lsb", 2),
    *(built(form, phase) for form in RAW for phase in range(4)),
)
MUTANTS = Mutants(repeats=2)
PROOFS = (
    *(
        Proof(FULL_WIDTH, {"Format": FORMATS[form].code, "Phase": phase})
        for form, phase in (
            *(("rgb888", 0), ("rgb565", 0), ("rgb565_bytes", 0), ("raw8", 1), ("raw10", 0), ("raw10_lsb", 2)),
            *(("raw12", 3), ("raw12_lsb", 0)),
        )
    ),
    Proof(FULL_WIDTH, {"Format": FORMATS["yuyv"].code}),
)


@cocotb.test
async def pixels(dut: Any) -> None:
    chance = random.Random(cocotb.RANDOM_SEED)
    marks = ("inside", "odd_row", "odd_column", "row_start", "frame_start")
    pins = {"en": 1.0, "in_valid": 1.0, "in_data": WORD, "in_abort": 0.3}
    pins |= dict.fromkeys((f"in_{mark}" for mark in marks), 1.0)

    def legal(core: PixelFormat, pins: Pins) -> None:
        """Send pairs of columns; every other word is random."""
        if core.camera.format.is_yuyv:
            pins["in_odd_column"] = core.first is not None
        if chance.getrandbits(1):
            pins["in_data"] = chance.getrandbits(24)

    await play(dut, PixelFormat(CameraConfiguration(**RUN.device["camera"])), pins, legal)
