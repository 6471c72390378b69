# SPDX-License-Identifier: Apache-2.0
"""td_node_map against its model in every clock."""

from typing import Any

import cocotb

from formal.entries import Proof
from formal.tables import node_rom
from tactile_depth.chip.common.td_node_map import NodeMap, latency, side
from tactile_depth.chip.fixed_point import joined
from tactile_depth.chip.rom_files import write_nodes
from tb.lockstep import WORD, play
from tb.nodes import Grid, first_words
from tb.stream import parameters
from tb.structures import ICARUS, VERILATOR, Structure
from tb.table_bus import at_power_up, legal_nodes, node_map_pins


def built(
    columns: int, rows: int, block_log2: int, width: int, channels: int, lanes: int, signed: int, **runs: Any
) -> Structure:
    nodes = first_words(rows >> block_log2, columns >> block_log2, channels, width)
    shape = {"Rows": rows, "Columns": columns, "BlockLog2": block_log2, "Width": width}
    return Structure(
        shape | {"Channels": channels, "Lanes": lanes, "Signed": signed, "Select": rows % 4},
        roms=lambda folder: write_nodes(folder, "nodes", nodes, width, side(lanes, block_log2)),
        **runs,
    )


# A beat of half a block, of a quarter, of a whole one, of several; rows of blocks that the frame cuts above their
# middle, and below; one pixel, with three words.
STRUCTURES = (
    built(32, 19, 2, 12, 1, 4, 1, on=VERILATOR),
    built(16, 11, 2, 4, 3, 1, 0, on=VERILATOR, mutants=ICARUS),
    built(16, 11, 2, 4, 1, 2, 0, on=ICARUS, mutants=ICARUS),
    built(16, 13, 3, 5, 1, 2, 1, on=ICARUS),
    built(16, 3, 1, 3, 1, 4, 1, on=ICARUS, mutants=ICARUS),
    built(4, 2, 1, 5, 1, 1, 0, on=ICARUS),
    built(4, 3, 1, 1, 2, 1, 0, on=ICARUS),
    built(16, 5, 1, 3, 2, 4, 0, on=ICARUS),
    built(128, 24, 3, 24, 1, 8, 1),
    built(128, 21, 3, 24, 1, 16, 1),
    built(256, 8, 3, 24, 1, 32, 1),
    built(128, 21, 3, 24, 1, 32, 1),
    built(64, 64, 2, 24, 1, 2, 1),
    built(128, 40, 4, 18, 1, 2, 1),
    built(32, 11, 1, 8, 1, 2, 1),
    built(16, 8, 1, 24, 3, 1, 0),
    built(32, 21, 2, 24, 3, 1, 0),
    built(128, 8, 3, 24, 3, 1, 0),
    built(64, 64, 2, 24, 3, 1, 0),
)
REFUSED = {
    "blocks_of_2_pixels_or_more_two_beats_and_two_blocks_a_row_and_one_block_a_column_are_needed": "BlockLog2=0, "
    "Columns=8, Rows=7, Lanes=128",
    "Columns_and_Lanes_must_be_powers_of_two_with_Lanes_of_two_blocks_Channels_too": "Columns=96, Lanes=3, "
    "Lanes=16 Channels=3",
}
PROTOCOL = "protocol_node_map"
PROOFS = tuple(
    Proof(
        "half a block to a beat, a whole one, two; a cut row of blocks; weights and sums are exact at any width",
        {
            "Along": along,
            "Rows": (2 << block_log2) + 1,
            "Columns": columns,
            "BlockLog2": block_log2,
            "Channels": channels,
            "Lanes": lanes,
            "Signed": signed,
            "Latency": latency(lanes, block_log2),
        },
        roms=node_rom("nodes", 2 * (columns >> block_log2), channels, side(lanes, block_log2)),
        free=("sums",) if along else (),
    )
    for along in (0, 1)
    for columns, block_log2, channels, lanes, signed in (
        (8, 2, 1, 2, 1),
        (4, 1, 1, 2, 1),
        (8, 1, 1, 4, 1),
        (4, 1, 3, 1, 0),
        (4, 1, 1, 1, 1),
    )
)


@cocotb.test
async def frames(dut: Any) -> None:
    grid, names = Grid.of(dut), ("Select", "Channels", "Lanes", "Signed")
    select, channels, lanes, signed = parameters(dut, *names)
    rows, columns = grid.reference_nodes
    nodes = first_words(rows, columns, channels, grid.depth.width)
    nodes = nodes.reshape(-1, channels * side(lanes, grid.reference_block_log2))
    entries = [joined(words, grid.depth.width) for words in nodes.tolist()]
    pins = node_map_pins(len(entries), select) | {"capture_words": WORD, "in_data": WORD}
    await play(dut, NodeMap(grid, at_power_up(entries), select, channels, lanes, signed), pins, legal_nodes)
