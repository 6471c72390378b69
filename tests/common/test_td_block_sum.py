# SPDX-License-Identifier: Apache-2.0
"""td_block_sum: RTL against the model, the model against a sum word by word."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from tactile_depth.chip.common.td_block_sum import block_sum


@given(arrays(np.int64, (2, 5, 8, 2), elements=st.integers(-8, 7)), st.integers(1, 2))
def test_each_word_of_a_whole_block_counts_once(frames: np.ndarray, block_log2: int) -> None:
    rows, columns = 5 >> block_log2, 8 >> block_log2
    expected = np.zeros((2, rows, columns, 2), np.int64)
    for frame, row, column, channel in np.ndindex(*frames.shape):
        if row >> block_log2 < rows:
            expected[frame, row >> block_log2, column >> block_log2, channel] += frames[frame, row, column, channel]
    np.testing.assert_array_equal(block_sum(frames, block_log2), expected)
