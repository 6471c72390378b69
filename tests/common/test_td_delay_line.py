# SPDX-License-Identifier: Apache-2.0
"""td_delay_line: RTL against the model, as registers (up to 4) and as memory."""

from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.common.td_delay_line import delay_line


@given(st.lists(st.integers()), st.integers(1, 9))
def test_a_word_leaves_its_delay_later(words: Any, delay: Any) -> None:
    out = delay_line(words, delay)
    assert len(out) == len(words)
    assert all(word is None for word in out[:delay])
    assert all(out[n] == words[n - delay] for n in range(delay, len(words)))
