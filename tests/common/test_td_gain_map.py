# SPDX-License-Identifier: Apache-2.0
"""td_gain_map: RTL against the model."""

from collections.abc import Callable

import pytest

from tactile_depth.common.td_gain_map import ENTRIES_PER_NODE, table_entries
from tactile_depth.rom_files import write_gains
from tb.gains import first_gains


@pytest.mark.structures(
    "columns rows block_log2 channels width",
    # A last row of blocks that the frame cuts above its middle, and below.
    verilator=[(16, 11, 2, 3, 4)],
    icarus=[(4, 2, 1, 1, 5), (4, 3, 1, 2, 1)],
    regress=[(16, 8, 1, 3, 24), (32, 21, 2, 3, 24), (128, 8, 3, 3, 24), (64, 64, 2, 3, 24), (16, 11, 2, 3, 4)],
)
def test_rtl(run_tb: Callable[..., None], columns: int, rows: int, block_log2: int, channels: int, width: int) -> None:
    gains = first_gains(rows >> block_log2, columns >> block_log2, channels, width)
    run_tb(
        "td_gain_map",
        {"Rows": rows, "Columns": columns, "BlockLog2": block_log2, "Channels": channels, "Width": width},
        roms=lambda folder: write_gains(folder, gains, width),
    )


def test_entries_are_the_channels_of_each_node() -> None:
    gains = [[[10, 11, 12], [20, 21, 22]]]
    assert table_entries(gains) == {0: 10, 1: 11, 2: 12, 4: 20, 5: 21, 6: 22}  # type: ignore[arg-type]
    assert table_entries([[[10], [20]]]) == {0: 10, 4: 20}  # type: ignore[arg-type]
    assert ENTRIES_PER_NODE == 4
