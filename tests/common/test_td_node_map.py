# SPDX-License-Identifier: Apache-2.0
"""td_node_map: RTL against the model; nodes side by side, latency and entries."""

from typing import Any

import numpy as np
import pytest

from formal.entries import Proof
from formal.tables import node_rom
from tactile_depth.chip.common.td_node_map import entries_per_node, latency, side, table_entries
from tactile_depth.chip.rom_files import write_nodes
from tb.nodes import first_words
from tb.structures import ICARUS, VERILATOR, Structure
from tests.rtl import test_rtl as test_rtl


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
    built(16, 11, 2, 4, 3, 1, 0, on=VERILATOR, mutants=True),
    built(16, 11, 2, 4, 1, 2, 0, on=ICARUS, mutants=True),
    built(16, 13, 3, 5, 1, 2, 1, on=ICARUS),
    built(16, 3, 1, 3, 1, 4, 1, on=ICARUS, mutants=True),
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
POWERS = "Columns_and_Lanes_must_be_powers_of_two_with_Lanes_of_two_blocks_Channels_too"
LEAST = "blocks_of_2_pixels_or_more_two_beats_and_two_blocks_a_row_and_one_block_a_column_are_needed"
REFUSED = {
    "BlockLog2=0": LEAST,
    "Columns=96": POWERS,
    "Columns=8": LEAST,
    "Rows=7": LEAST,
    "Lanes=3": POWERS,
    "Lanes=128": LEAST,
    "Lanes=16 Channels=3": POWERS,
}
PROOFS = tuple(
    Proof(
        claim,
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
        depth=50,
        roms=node_rom("nodes", 2 * (columns >> block_log2), channels, side(lanes, block_log2)),
        free=("sums",) if along else (),
    )
    for along, claim in (
        (0, "down a column: sums of the nodes of the bank named when the frame began; entries read; its latency"),
        (1, "along a row: words interpolated between any such sums, rounded to even; its latency"),
    )
    for columns, block_log2, channels, lanes, signed in (
        (8, 2, 1, 2, 1),
        (4, 1, 1, 2, 1),
        (8, 1, 1, 4, 1),
        (4, 1, 3, 1, 0),
        (4, 1, 1, 1, 1),
    )
)


@pytest.mark.parametrize(
    ("lanes", "block_log2", "nodes", "cycles"),
    [
        *((1, 1, 1, 10), (1, 3, 1, 10), (2, 3, 1, 11), (4, 3, 1, 12), (8, 3, 1, 12), (16, 3, 2, 12), (2, 1, 1, 10)),
        (32, 5, 1, 14),
    ],
)
def test_nodes_and_latency(lanes: int, block_log2: int, nodes: int, cycles: int) -> None:
    assert (side(lanes, block_log2), latency(lanes, block_log2)) == (nodes, cycles)


def test_entries_are_the_channels_of_each_node() -> None:
    nodes = np.array([[[10, 11, 12], [20, 21, 22]]])
    assert table_entries(nodes) == {0: 10, 1: 11, 2: 12, 4: 20, 5: 21, 6: 22}
    assert table_entries(nodes[..., :1]) == {0: 10, 1: 20}
    assert [entries_per_node(channels) for channels in (1, 2, 3)] == [1, 2, 4]
