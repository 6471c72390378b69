# SPDX-License-Identifier: Apache-2.0
"""gradient_lookup against its model in every clock."""

from pathlib import Path
from typing import Any

import cocotb

from formal.entries import WORD_FREE, Proof
from formal.tables import gradient_rom
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.gradient_lookup import GradientLookup, gradient_codes
from tactile_depth.chip.registers.register_map import TABLES
from tactile_depth.chip.rom_files import write_gradient
from tactile_depth.sensor.synthetic import synthetic
from tb.lockstep import WORD, Pins, play
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, Structure
from tb.table_bus import at_power_up, change_over, choices, pack


def built(bits: int, data_width: int, **runs: Any) -> Structure:
    choices: dict[str, Any] = {"columns": 16, "data_width": data_width, "bits_per_channel": bits}
    config = Configuration(**choices)
    width = config.gradient.width
    return Structure(
        {"Width": width, "BitsPerChannel": bits},
        device={"configuration": choices},
        roms=lambda folder: write_gradient(folder / "gradient.hex", gradient_codes(synthetic(bits), config), width),
        **runs,
    )


STRUCTURES = (built(2, 24, on=VERILATOR), built(1, 32, on=ICARUS, mutants=ICARUS), built(3, 12), built(4, 24))
PROOFS = (Proof(f"{WORD_FREE}; one bit a channel has the same index", roms=gradient_rom),)


def legal(lookup: GradientLookup, pins: Pins) -> None:
    """Write nothing that arrives in a change-over, and read nothing in the clock that writes."""
    table = lookup.table
    change_over(table, pins, bool(lookup.port.write))
    pins["table_write"] &= table.settled(pins["table_bank"])
    pins["table_read"] &= not pins["table_write"]
    pack(pins)


@cocotb.test()
async def pixels(dut: Any) -> None:
    width, bits = parameters(dut, "Width", "BitsPerChannel")
    entries = [int(line, 16) for line in Path("gradient.hex").read_text().split()]
    pins = {"en": 1.0, "in_valid": 1.0, "in_pixel": WORD, "in_position": range(16)}
    pins |= {**choices(TABLES["gradient"]), "table_bank": (0,), "commit": 0.3}
    await play(dut, GradientLookup(at_power_up(entries), bits, width), pins, legal)
