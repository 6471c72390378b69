# SPDX-License-Identifier: Apache-2.0
"""block_totals: RTL against the model, the model against sums pixel by pixel."""

import numpy as np
import pytest

from tactile_depth.chip.camera.block_totals import block_areas, block_totals
from tactile_depth.chip.camera.row_sums import red_columns, row_sums


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
