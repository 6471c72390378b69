# SPDX-License-Identifier: Apache-2.0
"""td_node_map: RTL against the model; nodes side by side and latency."""

from typing import Any

import pytest

from formal.entries import Proof
from formal.tables import zero_lanes_rom
from tactile_depth.common import td_node_map
from tactile_depth.common.td_node_map import latency, side
from tactile_depth.rom_files import write_zero
from tb.gains import first_gains
from tb.structures import ICARUS, VERILATOR, Structure
from tests.rtl import test_rtl as test_rtl


def built(columns: int, rows: int, block_log2: int, width: int, lanes: int, **runs: Any) -> Structure:
    zero = first_gains(rows >> block_log2, columns >> block_log2, 1, width) - (1 << width - 1)  # of the testbench
    return Structure(
        {"Rows": rows, "Columns": columns, "BlockLog2": block_log2, "Width": width, "Lanes": lanes},
        roms=lambda folder: write_zero(folder, zero, width, side(lanes, block_log2)),
        **runs,
    )


# A beat of half a block, of a quarter, of a whole one, of several; rows of blocks that the frame cuts.
STRUCTURES = (
    built(32, 19, 2, 12, 4, on=VERILATOR),
    built(16, 11, 2, 4, 2, on=ICARUS, mutants=True),
    built(16, 13, 3, 5, 2, on=ICARUS),
    built(16, 3, 1, 3, 4, on=ICARUS, mutants=True),
    built(128, 24, 3, 24, 8),
    built(128, 21, 3, 24, 16),
    built(256, 8, 3, 24, 32),
    built(128, 21, 3, 24, 32),
    built(64, 64, 2, 24, 2),
    built(128, 40, 4, 18, 2),
    built(32, 11, 1, 8, 2),
)
REFUSED = {
    "BlockLog2=0": "BlockLog2_must_be_at_least_1_a_run_is_half_a_block",
    "Columns=96": "Columns_and_Lanes_must_be_powers_of_two",
    "Columns=8": "Lanes_must_be_at_least_2_and_at_most_half_of_Columns",
    "Rows=7": "two_blocks_a_row_and_one_a_column_are_needed",
    "Lanes=1": "Lanes_must_be_at_least_2_and_at_most_half_of_Columns",
    "Lanes=3": "Columns_and_Lanes_must_be_powers_of_two",
    "Lanes=128": "Lanes_must_be_at_least_2_and_at_most_half_of_Columns",
}
PROOFS = tuple(
    Proof(
        claim,
        "a beat of a half, a whole block, two; a cut row of blocks; weights and sums are exact at any width",
        {
            "Along": along,
            "Rows": (2 << block_log2) + 1,
            "Columns": columns,
            "BlockLog2": block_log2,
            "Lanes": lanes,
            "Latency": td_node_map.latency(lanes, block_log2),
        },
        depth=50,
        roms=zero_lanes_rom(2 * (columns >> block_log2), td_node_map.side(lanes, block_log2)),
        free=("sums",) if along else (),
    )
    for along, claim in (
        (0, "down a column: sums of the nodes of the bank named when the frame began; entries read; its latency"),
        (1, "along a row: words interpolated between any such sums, rounded to even; its latency"),
    )
    for columns, block_log2, lanes in ((8, 2, 2), (4, 1, 2), (8, 1, 4))
)


@pytest.mark.parametrize(
    ("lanes", "block_log2", "nodes", "cycles"),
    [(2, 3, 1, 11), (4, 3, 1, 12), (8, 3, 1, 12), (16, 3, 2, 12), (2, 1, 1, 10), (32, 5, 1, 14)],
)
def test_nodes_and_latency(lanes: int, block_log2: int, nodes: int, cycles: int) -> None:
    assert (side(lanes, block_log2), latency(lanes, block_log2)) == (nodes, cycles)
