# SPDX-License-Identifier: Apache-2.0
"""flat_field against its model in every clock."""

import random
from functools import cache
from typing import Any

import cocotb

from formal.entries import ROUNDING, WORD_FREE, Proof
from formal.tables import gain_rom
from tactile_depth.chip.fixed_point import Format, joined, split
from tactile_depth.chip.gradient.flat_field import CODE, FlatField, flat_field_parameters, unit_gains
from tactile_depth.chip.limits import DEVIATION, RATIO
from tactile_depth.chip.registers.register_map import TABLES
from tactile_depth.chip.rom_files import write_gains
from tb.lockstep import CLOCKS, WORD, Pins, play
from tb.nodes import Grid
from tb.stream import parameters, raster
from tb.structures import ICARUS, VERILATOR, Structure
from tb.table_bus import at_power_up, legal_nodes, node_map_pins


def built(columns: int, rows: int, block_log2: int, output: Format, gain_width: int, **runs: Any) -> Structure:
    config = Grid(rows, columns, block_log2, Format(gain_width, 0))
    return Structure(
        flat_field_parameters(config, output),  # type: ignore[arg-type]
        roms=lambda folder: write_gains(folder, unit_gains(config), gain_width),  # type: ignore[arg-type]
        **runs,
    )


STRUCTURES = (
    built(16, 11, 2, CODE, 24, on=VERILATOR, mutants=ICARUS),
    built(16, 8, 1, DEVIATION, 17, on=ICARUS),
    built(16, 11, 2, DEVIATION, 24, mutants=ICARUS),
    built(32, 21, 1, CODE, 24),
    built(128, 8, 3, CODE, 24),
    built(64, 64, 2, DEVIATION, 24),
    built(16, 8, 1, RATIO, 17, mutants=ICARUS),
    built(16, 8, 1, DEVIATION, 16),
    built(128, 8, 3, DEVIATION, 17),
)
PROTOCOL = {
    "protocol_node_map": {
        "Channels": 3,
        "Select": "td_register_map_pkg::TableSelectReference",
        "in_frame_start": "&in_position[1:0]",
    },
    "in_position": "in_valid & ~rst ? place : in_position",
    "out_position out_red out_green out_blue": "counts_out_valid & out_valid",
    "capture_read_gains": "captured",
    "dark saturations": "live & ~reset",
}
PROOFS = (
    Proof(f"every clock reads a node; {WORD_FREE}", {"Meets": 1}, roms=gain_rom(2), free=("gains",)),
    *(
        Proof(
            f"products are exact at any width; {ROUNDING}",
            {"Meets": 0, "GainWidth": 4, "Drop": 1, "Offset": offset, "OutWidth": width, "Flat": flat},
            roms=gain_rom(2),
            free=("gains", "gain_valid", "gain_position", "colours", "dim"),
        )
        for offset, width, flat in ((0, 1, 1), (2, 2, 0))
    ),
)


@cache
def beside_tie(gain: int, drop: int, largest: int) -> int:
    """Return the code, of a product up to `largest`, that lies nearest to a tie: the lowest bits of the gain count."""
    half, mask = 1 << drop - 1, (1 << drop) - 1
    codes = range(min(255, (largest << drop) // max(gain, 1)) + 1)
    return min(codes, key=lambda code: abs((code * gain & mask) - half))


@cocotb.test()
async def frames(dut: Any) -> None:
    grid, chance = Grid.of(dut, "GainWidth"), random.Random(cocotb.RANDOM_SEED)
    width, marks = grid.depth.width, raster(grid.rows, grid.columns)
    names = ("Drop", "Offset", "OutWidth", "Flat")
    numbers = dict(zip(names, parameters(dut, *names), strict=True))
    largest = (1 << numbers["OutWidth"]) - 1
    entries = [joined(words, width) for words in unit_gains(grid).reshape(-1, 3).tolist()]
    gains = [
        [chance.getrandbits(width - chance.choice((0, *[1, 3, 3, 4, 4, 5] * 8))) for _ in range(3)] for _ in range(999)
    ]
    nodes = [joined(words, width) for words in gains]

    def legal(model: FlatField, pins: Pins) -> None:
        """Place each pixel in its frame; with `tie` beside a tie, while the capture writes any node."""
        gains = model.map.frame[model.map.place]
        if pins.pop("tie"):
            pins |= {"capture_write_node": chance.randrange(len(entries)), "capture_gains": chance.choice(nodes)}
            pins |= {"en": 1, "in_valid": 1, "dark_level": 0, "commit": chance.random() < 0.01}
            if gains is not None:
                red, green, blue = (beside_tie(gain, model.drop, largest) for gain in split(gains, 3, width))
                pins["in_pixel"] = joined([green, blue, red], 8)
        if pins["in_valid"]:
            pins["in_position"] = marks[model.map.place]
        legal_nodes(model.map, pins)
        del pins["in_frame_start"]

    pins = node_map_pins(len(entries), TABLES["reference"])
    pins |= {"capture_gains": nodes, "table_low": [word for word, *_ in gains], "tie": 1.0}
    pins |= {"in_pixel": WORD, "in_position": range(16), "dark_level": (0, 1, 16, 100, 255)}
    await play(dut, FlatField(grid, numbers, at_power_up(entries)), pins, legal, clocks=3 * CLOCKS)
