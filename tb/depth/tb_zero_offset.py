# SPDX-License-Identifier: Apache-2.0
"""zero_offset against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import ROUNDING, Proof
from formal.tables import zero_rom
from tactile_depth.chip.common.td_node_map import side
from tactile_depth.chip.depth.zero_offset import ZeroOffset
from tactile_depth.chip.depth.zero_offset import latency as zero_offset_latency
from tactile_depth.chip.fixed_point import joined
from tactile_depth.chip.registers.register_map import TABLES
from tactile_depth.chip.rom_files import write_zero
from tb.lockstep import WORD, Pins, play
from tb.nodes import Grid
from tb.stream import depth_position, parameters, places
from tb.structures import ICARUS, VERILATOR, Structure
from tb.table_bus import at_power_up, legal_nodes, node_map_pins


def built(columns: int, rows: int, block_log2: int, width: int, lanes: int, **runs: Any) -> Structure:
    zero = places((rows >> block_log2) * (columns >> block_log2), width)  # that of the testbench
    return Structure(
        {"Rows": rows, "Columns": columns, "BlockLog2": block_log2, "Width": width, "Lanes": lanes},
        roms=lambda folder: write_zero(folder, zero, width, side(lanes, block_log2)),
        **runs,
    )


STRUCTURES = (
    built(16, 15, 2, 4, 1, on=VERILATOR, mutants=ICARUS),
    built(32, 15, 2, 8, 4, on=VERILATOR),
    built(16, 8, 1, 24, 1, on=ICARUS),
    built(4, 2, 1, 5, 1, on=ICARUS),
    built(16, 11, 2, 6, 2, on=ICARUS, mutants=ICARUS),
    built(16, 16, 1, 12, 1),
    built(32, 21, 1, 16, 1),
    built(128, 8, 3, 32, 1),
    built(64, 64, 2, 24, 1),
    built(16, 16, 1, 12, 4),
    built(128, 21, 3, 24, 8),
    built(256, 8, 3, 32, 32),
    built(128, 21, 3, 24, 32),
    built(128, 21, 3, 24, 64),
    built(16, 9, 1, 12, 8, on=ICARUS),
    built(64, 35, 5, 16, 4),
)
PROTOCOL = {
    "protocol_node_map": {
        "Select": "td_register_map_pkg::TableSelectZero",
        "in_frame_start": "in_position[2]",
        "capture_read": "1'b0",
        "capture_read_node": "'0",
    },
    "in_position": "in_valid & ~rst ? {&place[1:0], place[3], &place[3:2]} : in_position",
    "out_position": "counts_out_data",
    "saturations": "live & ~reset",
}
PROOFS = tuple(
    Proof(
        f"subtraction is exact at any width; {ROUNDING}; td_node_map is proven by itself",
        {"Rows": 2, "Lanes": lanes, "Latency": zero_offset_latency(lanes, 1)},
        roms=zero_rom,
        free=("zero_words",),
    )
    for lanes in (1, 2)
)


def legal(model: ZeroOffset, pins: Pins) -> None:
    """Place each beat in its frame; the capture reads nothing."""
    nodes = model.map
    if pins["in_valid"]:
        row_end = (nodes.place + 1) % (nodes.size // model.rows) == 0
        pins["in_position"] = depth_position(nodes.place == 0, row_end, nodes.place == nodes.size - 1)
    legal_nodes(nodes, pins)
    for name in ("in_frame_start", "capture_read", "capture_read_node"):
        del pins[name]


@cocotb.test
async def frames(dut: Any) -> None:
    grid, (lanes,) = Grid.of(dut), parameters(dut, "Lanes")
    rows, columns = grid.reference_nodes
    zero = places(rows * columns, grid.depth.width).reshape(-1, side(lanes, grid.reference_block_log2))
    entries = [joined(words, grid.depth.width) for words in zero.tolist()]
    pins = node_map_pins(len(entries), TABLES["zero"])
    pins |= {"capture_zero": WORD, "in_data": WORD, "in_position": range(8)}
    await play(dut, ZeroOffset(grid, at_power_up(entries), lanes), pins, legal)
