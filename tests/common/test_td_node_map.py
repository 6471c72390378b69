# SPDX-License-Identifier: Apache-2.0
"""td_node_map: RTL against the model; nodes side by side and latency."""

from collections.abc import Callable

import pytest

from tactile_depth.common.td_node_map import latency, side
from tactile_depth.rom_files import write_zero
from tb.gains import first_gains


@pytest.mark.structures(
    "columns rows block_log2 width lanes",
    # A beat of half a block, of a quarter, of a whole one, of several; rows of blocks that the frame cuts.
    verilator=[(32, 19, 2, 12, 4)],
    icarus=[(16, 11, 2, 4, 2), (16, 13, 3, 5, 2), (16, 3, 1, 3, 4)],
    regress=[
        (128, 24, 3, 24, 8),
        (128, 21, 3, 24, 16),
        (256, 8, 3, 24, 32),
        (128, 21, 3, 24, 32),
        (64, 64, 2, 24, 2),
        (128, 40, 4, 18, 2),
        (32, 11, 1, 8, 2),
    ],
)
def test_rtl(run_tb: Callable[..., None], columns: int, rows: int, block_log2: int, width: int, lanes: int) -> None:
    zero = first_gains(rows >> block_log2, columns >> block_log2, 1, width) - (1 << width - 1)  # of the testbench
    run_tb(
        "td_node_map",
        {"Rows": rows, "Columns": columns, "BlockLog2": block_log2, "Width": width, "Lanes": lanes},
        roms=lambda folder: write_zero(folder, zero, width, side(lanes, block_log2)),
    )


@pytest.mark.parametrize(
    ("lanes", "block_log2", "nodes", "cycles"),
    [(2, 3, 1, 11), (4, 3, 1, 12), (8, 3, 1, 12), (16, 3, 2, 12), (2, 1, 1, 10), (32, 5, 1, 14)],
)
def test_nodes_and_latency(lanes: int, block_log2: int, nodes: int, cycles: int) -> None:
    assert (side(lanes, block_log2), latency(lanes, block_log2)) == (nodes, cycles)
