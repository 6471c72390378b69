# SPDX-License-Identifier: Apache-2.0
"""ram: RTL against the model in every style, with and without contents at power-up; the same of an ECP5."""

import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from cocotb_tools.runner import as_sv_literal
from hypothesis import given
from hypothesis import strategies as st

from commands.common.repository import ROOT
from commands.hardware.ecp5 import write_slices
from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.common.td_ram import ram
from tactile_depth.chip.rom_files import write_words
from tb.structures import ICARUS, VERILATOR, Structure
from tests.rtl import test_rtl as test_rtl

DISTRIBUTED, BLOCK, ULTRA = range(3)


def built(width: int, depth: int, style: int, file: str = "", **runs: Any) -> Structure:
    def contents(folder: Path) -> None:
        if file:
            chance = random.Random(depth)
            write_words(folder / file, [chance.getrandbits(width) for _ in range(depth)], width)
            write_slices(folder)

    parameters = {"Width": width, "Depth": depth, "Style": style}
    named = {"File": as_sv_literal(file)} if file else {}
    return Structure(parameters | named, device={"file": file}, roms=contents, **runs)


STRUCTURES = (
    built(24, 64, BLOCK, "contents.hex", on=VERILATOR),
    built(5, 16, DISTRIBUTED, on=ICARUS, mutants=True),
    built(9, 24, DISTRIBUTED, "contents.hex", on=ICARUS),
    built(70, 32, ULTRA, on=ICARUS),
)
REFUSED = {
    "Depth=1": "Depth_must_be_at_least_2",
    'Style=2 File="contents.hex"': "an_ultra_memory_has_no_contents_at_power_up",
}
PROOFS = tuple(
    Proof("a read returns what was last written to its address", WORD_FREE, {"Style": style}) for style in (0, 1, 2)
)
OF_ECP5 = (
    built(21, 4096, BLOCK, "contents.hex", on=VERILATOR, late=()),
    built(9, 16384, BLOCK, on=VERILATOR, late=()),
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
