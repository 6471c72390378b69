# SPDX-License-Identifier: Apache-2.0
"""zero_offset: RTL against the model, and the model against its definition."""

from typing import Any

import numpy as np
import pytest

from formal.entries import ROUNDING, Proof
from formal.tables import zero_rom
from tactile_depth.chip.common.td_node_map import node_map, side
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.depth.zero_capture import captured_zero
from tactile_depth.chip.depth.zero_offset import exact_zero, no_zero, zero_offset
from tactile_depth.chip.depth.zero_offset import latency as zero_offset_latency
from tactile_depth.chip.rom_files import write_zero
from tb.stream import places
from tb.structures import ICARUS, VERILATOR, Structure
from tests.rtl import test_rtl as test_rtl


def built(columns: int, rows: int, block_log2: int, width: int, lanes: int, **runs: Any) -> Structure:
    zero = places((rows >> block_log2) * (columns >> block_log2), width)  # that of the testbench
    return Structure(
        {"Rows": rows, "Columns": columns, "BlockLog2": block_log2, "Width": width, "Lanes": lanes},
        roms=lambda folder: write_zero(folder, zero, width, side(lanes, block_log2)),
        **runs,
    )


STRUCTURES = (
    built(16, 15, 2, 4, 1, on=VERILATOR, mutants=True),
    built(32, 15, 2, 8, 4, on=VERILATOR),
    built(16, 8, 1, 24, 1, on=ICARUS, late=VERILATOR),
    built(4, 2, 1, 5, 1, on=ICARUS),
    built(16, 11, 2, 6, 2, on=ICARUS, mutants=True),
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
    built(64, 19, 5, 16, 4),
)
REFUSED = {  # by td_node_map
    **dict.fromkeys(
        ("BlockLog2=0", "Columns=8", "Rows=7", "Lanes=128"),
        "blocks_of_2_pixels_or_more_two_beats_and_two_blocks_a_row_and_one_block_a_column_are_needed",
    ),
    **dict.fromkeys(
        ("Columns=96", "Lanes=3"), "Columns_and_Lanes_must_be_powers_of_two_with_Lanes_of_two_blocks_Channels_too"
    ),
}
PROOFS = tuple(
    Proof(
        "the depths of an arbitrary beat less whatever td_node_map holds, saturated, counted "
        "if clipped, with their marks; its latency; active while a frame is inside; zero offsets read back",
        f"subtraction is exact at any width; {ROUNDING}; td_node_map is proven by itself",
        {"Rows": 2, "Lanes": lanes, "Latency": zero_offset_latency(lanes, 1)},
        depth=45,
        roms=zero_rom,
        free=("zero_words",),
    )
    for lanes in (1, 2)
)


CONFIG = Configuration(columns=32, rows=21, solver="tridiagonal")
HIGHEST = (1 << CONFIG.depth.width - 1) - 1


def codes(count: int = 2, limit: int = HIGHEST) -> Any:
    return np.random.default_rng(1).integers(-limit - 1, limit, (count, 21, 32), endpoint=True)


def test_no_zero_changes_nothing() -> None:
    monitor = Monitor()
    np.testing.assert_array_equal(zero_offset(codes(), no_zero(CONFIG), CONFIG, monitor), codes())
    assert not monitor.saturations


@pytest.mark.parametrize("level", [-1000, -1, 1, 77777])
def test_a_flat_zero_is_subtracted_everywhere(level: int) -> None:
    zero = np.full(CONFIG.reference_nodes, level)
    assert np.all(node_map(zero, CONFIG) == level)
    low = codes(limit=HIGHEST // 2)
    np.testing.assert_array_equal(zero_offset(low, zero, CONFIG), low - level)


def test_what_is_clipped_is_counted() -> None:
    monitor = Monitor()
    zero = np.full(CONFIG.reference_nodes, -2)
    depths = np.zeros((21, 32), np.int64)
    depths[3, 4:9] = HIGHEST - np.arange(5)
    zeroed = zero_offset(depths, zero, CONFIG, monitor)
    assert zeroed[3, 4:9].tolist() == [HIGHEST, HIGHEST, HIGHEST, HIGHEST - 1, HIGHEST - 2]
    assert monitor.saturations == {"zero_offset": 2}
    zero_offset(np.full((21, 32), -HIGHEST - 1), np.full(CONFIG.reference_nodes, 1), CONFIG, monitor)
    assert monitor.saturations == {"zero_offset": 2 + 21 * 32}


def test_exact_zero_is_the_same_but_for_rounding() -> None:
    untouched, depths = codes(4, 5000), codes(3, 100000)
    zeroed = zero_offset(depths, captured_zero(untouched, CONFIG), CONFIG)
    exact = exact_zero(depths.astype(float), untouched.astype(float), CONFIG)
    assert 0 < np.abs(zeroed - exact).max() <= 1


def test_a_zero_that_is_a_plane_is_taken_off_between_the_centres_of_blocks() -> None:
    """Subtract a plane. In a cut row of blocks, which has no node, and beyond the outermost centres the zero offset is
    constant."""
    row, column = np.mgrid[:21, :32]
    plane = 400 * row - 600 * column + 5000
    zeroed = zero_offset(plane, captured_zero(plane[None], CONFIG), CONFIG)
    assert not zeroed[1:19, 1:31].any()
    assert zeroed[20].any()
