# SPDX-License-Identifier: Apache-2.0
"""td_delay_line: RTL against the model, as registers (up to 4) and as memory."""

from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.common.td_delay_line import delay_line


@pytest.mark.structures(
    "width delay",
    verilator=[(54, 65)],
    icarus=[(1, 1), (9, 2), (8, 4), (8, 5)],
    regress=[(70, 8), (12, 33), (70, 128), (54, 65)],
)
def test_rtl(run_tb: Callable[..., None], width: int, delay: Any) -> None:
    run_tb("td_delay_line", {"Width": width, "Delay": delay})


@given(st.lists(st.integers()), st.integers(1, 9))
def test_a_word_leaves_its_delay_later(words: Any, delay: Any) -> None:
    out = delay_line(words, delay)
    assert len(out) == len(words)
    assert all(word is None for word in out[:delay])
    assert all(out[n] == words[n - delay] for n in range(delay, len(words)))
