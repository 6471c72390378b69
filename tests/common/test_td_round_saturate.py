# SPDX-License-Identifier: Apache-2.0
"""td_round_saturate: RTL against the model, the model against Python's own rounding of fractions."""

from fractions import Fraction
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.bounds import Responses
from tactile_depth.chip.common.td_round_saturate import Monitor, round_half_even, round_saturate


@given(st.integers(-(2**50), 2**50), st.integers(-10, 45))
def test_rounding_is_that_of_fractions(x: Any, drop: Any) -> None:
    assert round_half_even(np.array([x]), drop) == [round(Fraction(x) / Fraction(2) ** drop)]


@given(st.lists(st.tuples(st.integers(-(2**50), 2**50), st.integers(1, 45)), min_size=1))
def test_each_word_may_have_its_own_drop(pairs: Any) -> None:
    x, drop = np.array(pairs).T
    assert round_half_even(x, drop).tolist() == [round(Fraction(a, 2**d)) for a, d in pairs]


@given(st.integers(-(2**20), 2**20), st.integers(-4, 12), st.integers(2, 24))
def test_saturation_clips_and_counts(x: Any, drop: Any, width: int) -> None:
    monitor = Monitor()
    out = int(round_saturate(np.array([x]), drop, width, monitor, "node")[0])
    rounded = round(Fraction(x) / Fraction(2) ** drop)
    assert out == min(max(rounded, -(2 ** (width - 1))), 2 ** (width - 1) - 1)
    assert monitor.saturations == ({"node": 1} if out != rounded else {})


@given(st.lists(st.floats(-1e9, 1e9), min_size=1), st.integers(-10, 45))
def test_floats_pass_unrounded_and_are_reported(x: np.ndarray, drop: int) -> None:
    monitor = Responses()
    response = np.array(x)[:, None]
    for values in (round_saturate(response, drop, 2, monitor, "node"), monitor.nodes["node"]):
        np.testing.assert_array_equal(values, response / 2.0**drop)
