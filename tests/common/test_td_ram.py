# SPDX-License-Identifier: Apache-2.0
"""ram: RTL against the model in every style, with and without contents at power-up; the same of an ECP5."""

from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from commands.common.repository import ROOT
from tactile_depth.chip.common.td_ram import ram
from tb.common.tb_td_ram import BLOCK, DISTRIBUTED, built
from tb.structures import ICARUS, VERILATOR, Structure

OF_ECP5 = (
    built(21, 4096, BLOCK, "contents.hex", on=VERILATOR),
    built(9, 16384, BLOCK, on=VERILATOR),
    built(5, 2500, BLOCK, "contents.hex", on=ICARUS),
    built(11, 5000, BLOCK, "contents.hex", on=ICARUS),
    built(9, 24, DISTRIBUTED, "contents.hex", on=ICARUS),
)


@pytest.mark.structures(OF_ECP5)
def test_ecp5(run_tb: Callable[..., None], structure: Structure) -> None:
    run_tb(structure, files=[ROOT / "boards" / "ecp5" / "td_ram.sv"])


@given(st.lists(st.tuples(st.integers(0, 7), st.integers(0, 255)), max_size=40))
def test_a_word_is_the_last_one_written_there(writes: Any) -> None:
    words, _ = ram([None] * 8, [(True, place, word, False, 0) for place, word in writes])
    assert {place: word for place, word in enumerate(words) if word is not None} == dict(writes)


def test_read_data_stays_between_reads() -> None:
    clocks = [(True, 0, 5, False, 0), (False, 0, 0, True, 0), (True, 0, 6, False, 0), (False, 0, 0, True, 0)]
    assert ram([None], clocks)[1] == [None, 5, 5, 6]
