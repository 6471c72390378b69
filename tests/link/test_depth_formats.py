# SPDX-License-Identifier: Apache-2.0
"""Depth values as bytes in each format, and how many frames a line carries."""

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from tactile_depth.chip.link.depth_formats import (
    DepthFormat,
    exact_shift,
    from_bytes,
    sent_shape,
    to_bytes,
    value_bytes,
)


@given(st.integers(12, 32), st.data())
def test_words_are_sign_extended_to_whole_bytes(width: int, data: Any) -> None:
    limit = 1 << width - 1
    codes = data.draw(hnp.arrays(np.int32, (3, 4), elements=st.integers(-limit, limit - 1)))
    size = value_bytes(DepthFormat.WORDS, width)
    sent = to_bytes(codes, DepthFormat.WORDS, width, 0)
    assert sent == b"".join(int(code).to_bytes(size, "little", signed=True) for code in codes.flat)
    np.testing.assert_array_equal(from_bytes(sent, size).reshape(3, 4), codes)


@given(st.integers(0, 16), hnp.arrays(np.int32, (5, 4), elements=st.integers(-(1 << 31), (1 << 31) - 1)))
def test_16_bit_values_are_rounded_once_and_clipped(shift: int, codes: Any) -> None:
    for depth_format, height in ((DepthFormat.SHORT, 1), (DepthFormat.AVERAGED, 2)):
        rows, columns = sent_shape(depth_format, *codes.shape)
        values = from_bytes(to_bytes(codes, depth_format, 32, shift), 2).reshape(rows, columns)
        for row, column in np.ndindex(rows, columns):
            block = codes[height * row :, height * column :][:height, :height]
            mean = Fraction(sum(map(int, block.flat)), block.size) / 2**shift
            assert values[row, column] == min(max(round(mean), -32768), 32767)  # of a Fraction: ties to even


@pytest.mark.parametrize(
    ("code", "value"),
    [(128, 0), (129, 1), (384, 2), (-128, 0), (-129, -1), (-384, -2), ((1 << 23) - 1, 32767), (-(1 << 23), -32768)],
)
def test_ties_go_to_even_and_the_largest_code_is_clipped(code: int, value: int) -> None:
    codes = np.full((2, 2), code, np.int32)
    for depth_format in (DepthFormat.SHORT, DepthFormat.AVERAGED):
        assert set(from_bytes(to_bytes(codes, depth_format, 24, exact_shift(24)), 2)) == {value}


def test_the_shift_keeps_the_whole_range() -> None:
    assert [exact_shift(width) for width in (12, 16, 17, 24, 32)] == [0, 0, 1, 8, 16]
