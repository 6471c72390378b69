# SPDX-License-Identifier: Apache-2.0
"""td_burst_counter: RTL against the model."""

from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.common.td_burst_counter import burst_counter


def test_bursts_apart_back_to_back_and_begun_again() -> None:
    starts = [0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 0]
    assert burst_counter(map(bool, starts), 3) == [None, 0, 1, 2, None, 0, 1, 2, 0, 1, 0, 1, 2, None]


@given(st.lists(st.booleans()), st.integers(2, 9))
def test_the_position_counts_clocks_since_the_last_start(starts: Any, words: int) -> None:
    for clock, position in enumerate(burst_counter(starts, words)):
        since = next((n for n in range(min(words, clock + 1)) if starts[clock - n]), None)
        assert position == since
