# SPDX-License-Identifier: Apache-2.0
"""td_delay_line: RTL against the model, as registers (up to 4) and as memory."""

from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.common.td_delay_line import delay_line
from tb.structures import ICARUS, VERILATOR, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("Width Delay")
STRUCTURES = (
    built(54, 65, on=VERILATOR),
    built(1, 1, on=ICARUS),
    built(9, 2, on=ICARUS),
    built(8, 4, on=ICARUS, mutants=True),
    built(8, 5, on=ICARUS, mutants=True),
    built(70, 8),
    built(12, 33),
    built(70, 128),
)
REFUSED = {
    "Delay=0": "Delay_must_be_at_least_1",
}
PROOFS = tuple(
    Proof(
        "out is in, Delay enabled clocks later; holds while en is low",
        why,
        {"Delay": delay},
        depth=30,
    )
    for delay, why in (
        (1, "the smallest"),
        (4, f"the longest of registers; {WORD_FREE}"),
        (5, f"the shortest in memory; {WORD_FREE}"),
        (8, f"in memory, the pointer runs over at a power of two; {WORD_FREE}"),
    )
)


@given(st.lists(st.integers()), st.integers(1, 9))
def test_a_word_leaves_its_delay_later(words: Any, delay: Any) -> None:
    out = delay_line(words, delay)
    assert len(out) == len(words)
    assert all(word is None for word in out[:delay])
    assert all(out[n] == words[n - delay] for n in range(delay, len(words)))
