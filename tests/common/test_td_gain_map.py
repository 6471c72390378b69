# SPDX-License-Identifier: Apache-2.0
"""td_gain_map: RTL against the model."""

from typing import Any

from formal.entries import Proof
from formal.tables import gain_rom
from tactile_depth.common.td_gain_map import ENTRIES_PER_NODE, table_entries
from tactile_depth.latency import GAIN_MAP
from tactile_depth.rom_files import write_gains
from tb.gains import first_gains
from tb.structures import ICARUS, VERILATOR, Structure
from tests.rtl import test_rtl as test_rtl


def built(columns: int, rows: int, block_log2: int, channels: int, width: int, **runs: Any) -> Structure:
    gains = first_gains(rows >> block_log2, columns >> block_log2, channels, width)
    return Structure(
        {"Rows": rows, "Columns": columns, "BlockLog2": block_log2, "Channels": channels, "Width": width},
        roms=lambda folder: write_gains(folder, gains, width),
        **runs,
    )


# A last row of blocks that the frame cuts above its middle, and below.
STRUCTURES = (
    built(16, 11, 2, 3, 4, on=VERILATOR, mutants=True),
    built(4, 2, 1, 1, 5, on=ICARUS),
    built(4, 3, 1, 2, 1, on=ICARUS),
    built(16, 8, 1, 3, 24),
    built(32, 21, 2, 3, 24),
    built(128, 8, 3, 3, 24),
    built(64, 64, 2, 3, 24),
)
REFUSED = {
    "BlockLog2=0": "BlockLog2_must_be_at_least_1_a_node_is_read_in_a_clock_and_two_are_needed",
    "Columns=96": "Columns_must_be_a_power_of_two",
    "Columns=8": "two_blocks_a_row_and_one_a_column_are_needed",
    "Rows=7": "two_blocks_a_row_and_one_a_column_are_needed",
}
PROOFS = tuple(
    Proof(
        claim,
        "blocks of 2, where every clock reads a node; a cut row of blocks; weights and sums are exact at any width",
        {"Along": along, "Columns": 4, "Channels": channels, "Latency": GAIN_MAP},
        depth=45,
        roms=gain_rom(4),
        free=("sums",) if along else (),
    )
    for along, channels, claim in (
        (
            0,
            3,
            "down a column: sums of the nodes of the bank named when the frame began; entries read; its latency",
        ),
        (0, 1, "the same of one channel alone"),
        (1, 3, "along a row: gains interpolated between any such sums, rounded to even; its latency"),
    )
)


def test_entries_are_the_channels_of_each_node() -> None:
    gains = [[[10, 11, 12], [20, 21, 22]]]
    assert table_entries(gains) == {0: 10, 1: 11, 2: 12, 4: 20, 5: 21, 6: 22}  # type: ignore[arg-type]
    assert table_entries([[[10], [20]]]) == {0: 10, 4: 20}  # type: ignore[arg-type]
    assert ENTRIES_PER_NODE == 4
