# SPDX-License-Identifier: Apache-2.0
"""block_totals: RTL against the model, the model against sums pixel by pixel."""

from typing import Any

import numpy as np
import pytest

from formal.entries import Proof
from tactile_depth.chip.camera.block_totals import block_areas, block_totals
from tactile_depth.chip.camera.row_sums import red_columns, row_sums
from tb.structures import ICARUS, VERILATOR, Structure
from tests.rtl import test_rtl as test_rtl


def built(columns: int, numerator: int, denominator: int, width: int, bayer: int, **runs: Any) -> Structure:
    ratio = {"Numerator": numerator, "Denominator": denominator}
    return Structure({"Columns": columns, **ratio, "Width": width, "Bayer": bayer}, **runs)


STRUCTURES = (
    built(8, 15, 4, 12, 1, on=VERILATOR),
    built(5, 4, 3, 5, 0, on=ICARUS, late=VERILATOR, mutants=True),
    built(4, 5, 2, 4, 1, on=ICARUS, mutants=True),
    built(8, 1, 1, 10, 0),
    built(4, 8, 1, 14, 1),
    built(128, 15, 4, 10, 0),
    built(8, 2, 1, 10, 1),
)
REFUSED = {
    "Columns=3": "Columns_must_be_at_least_4_or_a_word_is_read_while_it_is_written",
}
PROOFS = tuple(
    Proof(
        "a word with each complete block, with its areas" + (" and totals" if totals else "") + "; latency 3; memory "
        "as td_ram.sv asks",
        "columns are only counted; totals are left to simulation where a block has several rows",
        {"Numerator": numerator, "Denominator": denominator, "Bayer": bayer, "Totals": totals},
        depth=60,
    )
    for numerator, denominator, bayer, totals in ((1, 1, 0, 1), (3, 2, 0, 0), (5, 2, 1, 0))
)


@pytest.mark.parametrize("colour", [(0, 0), (0, 1), (1, 0), (1, 1)])
def test_each_pixel_of_a_pattern_is_in_the_total_of_its_colour(colour: tuple[int, int]) -> None:
    numerator, denominator = 5, 2
    rng = np.random.default_rng(1)
    samples = rng.integers(-50, 50, (10, 10))
    blue_rows, blue_columns = ((np.arange(10) + first) % 2 == 1 for first in colour)
    sums = row_sums(samples, blue_columns, numerator, denominator)
    totals = block_totals(sums, blue_rows, numerator, denominator)
    red_rows, red = (red_columns(blue, numerator, denominator) for blue in (blue_rows, blue_columns))
    areas = block_areas(red_rows, red, numerator)
    want_totals, want_areas = np.zeros((4, 4, 3), np.int64), np.zeros((4, 4, 3), np.int64)
    for row, column in np.ndindex(10, 10):
        of = int(blue_rows[row]) + int(blue_columns[column])
        for i, j in np.ndindex(4, 4):
            height, width = (
                max(0, min(pixel * 2 + 2, block * 5 + 5) - max(pixel * 2, block * 5))
                for pixel, block in ((row, i), (column, j))
            )
            want_totals[i, j, of] += height * width * samples[row, column]
            want_areas[i, j, of] += height * width
    np.testing.assert_array_equal(totals, want_totals)
    np.testing.assert_array_equal(areas, want_areas)


def test_areas_of_one_block_add_up() -> None:
    assert block_areas(np.array([7]), np.array([8]), 15).tolist() == [[[56, 15 * 15 - 56 - 56, 56]]]
