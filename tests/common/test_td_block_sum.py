# SPDX-License-Identifier: Apache-2.0
"""td_block_sum: RTL against the model, the model against a sum word by word."""

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from formal.entries import Proof
from tactile_depth.chip.common.td_block_sum import block_sum
from tb.structures import ICARUS, VERILATOR, Structure
from tests.rtl import test_rtl as test_rtl


def built(*case: int, **runs: Any) -> Structure:
    names = ("Rows", "Columns", "BlockLog2", "ColumnLog2", "Channels", "Width", "Signed", "SumWidth")
    return Structure(dict(zip(names, case, strict=True)), **runs)


STRUCTURES = (
    built(21, 16, 2, 2, 1, 24, 1, 38, on=VERILATOR),
    built(5, 8, 1, 1, 3, 8, 0, 11, on=ICARUS, mutants=True),
    built(5, 4, 1, 1, 1, 4, 1, 8, on=ICARUS),
    built(7, 4, 1, 0, 2, 5, 1, 10, on=ICARUS, mutants=True),
    built(8, 16, 1, 1, 3, 8, 0, 24),
    built(16, 16, 3, 3, 1, 12, 1, 24),
    built(21, 16, 3, 1, 1, 24, 1, 38),
)
REFUSED = {
    "BlockLog2=0": "BlockLog2_must_be_at_least_1",
    "Columns=96": "Columns_must_be_a_power_of_two",
    "Columns=8": "two_blocks_a_row_and_one_a_column_are_needed",
    "Rows=7": "two_blocks_a_row_and_one_a_column_are_needed",
    "SumWidth=27": "SumWidth_must_be_more_than_Width_plus_ColumnLog2",
}
PROOFS = tuple(
    Proof(
        "a block's sum written 4 clocks behind its rows; an arbitrary word is added once to its block, to no other",
        "a cut row of blocks; rows, columns and frames are only counted; sums are exact at any width",
        {"Signed": signed, "ColumnLog2": column_log2},
        depth=40,
    )
    for signed, column_log2 in ((0, 1), (1, 1), (1, 0))
)


@given(arrays(np.int64, (2, 5, 8, 2), elements=st.integers(-8, 7)), st.integers(1, 2))
def test_each_word_of_a_whole_block_counts_once(frames: np.ndarray, block_log2: int) -> None:
    rows, columns = 5 >> block_log2, 8 >> block_log2
    expected = np.zeros((2, rows, columns, 2), np.int64)
    for frame, row, column, channel in np.ndindex(*frames.shape):
        if row >> block_log2 < rows:
            expected[frame, row >> block_log2, column >> block_log2, channel] += frames[frame, row, column, channel]
    np.testing.assert_array_equal(block_sum(frames, block_log2), expected)
