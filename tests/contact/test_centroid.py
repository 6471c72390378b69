# SPDX-License-Identifier: Apache-2.0
"""centroid: RTL against the model, and the model against exact fractions."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.contact.centroid import FRACTION, mean


@given(st.lists(st.tuples(st.integers(0, 1023), st.integers(1, 2**32 - 1)), min_size=1, max_size=300))
def test_the_mean_is_the_nearest(pixels: list[tuple[int, int]]) -> None:
    moment, weight = sum(position * weight for position, weight in pixels), sum(weight for _, weight in pixels)
    assert mean(moment, weight, 10) == round(Fraction(moment, weight) * 2**FRACTION)  # of a Fraction: ties to even


def test_a_moment_beyond_the_largest_position_is_refused() -> None:
    with pytest.raises(ValueError, match="too large for a weight of 3 and positions of 4 bits"):
        mean(48, 3, 4)
