# SPDX-License-Identifier: Apache-2.0
"""row_sums: RTL against the model, the model against overlaps computed pixel by pixel."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.camera.row_sums import red_columns, sums_over_blocks


@given(st.integers(1, 12), st.integers(0, 40), st.integers(1, 12), st.integers(0, 2**32 - 1))
def test_sums_are_weighted_by_overlaps(denominator: int, extra: int, blocks: int, seed: int) -> None:
    numerator = denominator + extra
    values = np.random.default_rng(seed).integers(-100, 100, -(-blocks * numerator // denominator))
    begin = np.arange(len(values)) * denominator
    got = sums_over_blocks(values, numerator, denominator)
    for block in range(blocks):
        first, end = block * numerator, (block + 1) * numerator
        overlaps = np.clip(np.minimum(begin + denominator, end) - np.maximum(begin, first), 0, None)
        assert got[block] == overlaps @ values


@given(st.integers(1, 6), st.integers(0, 10), st.booleans())
def test_columns_of_red_and_blue_fill_a_block(denominator: int, extra: int, first: bool) -> None:
    numerator = 2 * denominator + extra
    blue = (np.arange(40) + first) % 2 == 1
    red = red_columns(blue, numerator, denominator)
    np.testing.assert_array_equal(red + red_columns(~blue, numerator, denominator), numerator)
    assert red.min() > 0  # from a ratio of 2 on every block has both
    assert red.max() < numerator
