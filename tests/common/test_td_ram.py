# SPDX-License-Identifier: Apache-2.0
"""ram: RTL against the model in every style, with and without contents at power-up; the same of an ECP5."""

import random
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest
from cocotb_tools.runner import as_sv_literal
from hypothesis import given
from hypothesis import strategies as st

from commands.common.repository import ROOT
from commands.hardware.ecp5 import write_slices
from tactile_depth.common.td_ram import ram
from tactile_depth.rom_files import write_words

DISTRIBUTED, BLOCK, ULTRA = range(3)


@pytest.mark.structures(
    "width depth style file",
    verilator=[(24, 64, BLOCK, "contents.hex")],
    icarus=[(5, 16, DISTRIBUTED, None), (9, 24, DISTRIBUTED, "contents.hex"), (70, 32, ULTRA, None)],
    regress=[(24, 64, BLOCK, "contents.hex")],
)
def test_rtl(run_tb: Callable[..., None], width: int, depth: int, style: int, file: str | None) -> None:
    check(run_tb, width, depth, style, file)


@pytest.mark.structures(
    "width depth style file",
    verilator=[(21, 4096, BLOCK, "contents.hex"), (9, 16384, BLOCK, None)],
    icarus=[(5, 2500, BLOCK, "contents.hex"), (11, 5000, BLOCK, "contents.hex"), (9, 24, DISTRIBUTED, "contents.hex")],
)
def test_ecp5(run_tb: Callable[..., None], width: int, depth: int, style: int, file: str | None) -> None:
    check(run_tb, width, depth, style, file, files=[ROOT / "boards" / "ecp5" / "td_ram.sv"])


def check(
    run_tb: Callable[..., None], width: int, depth: int, style: int, file: str | None, files: Sequence[Path] = ()
) -> None:
    """Run the testbench on a structure; with `files` on what takes the place of the core."""

    def contents(folder: Path) -> None:
        if file:
            chance = random.Random(depth)
            write_words(folder / file, [chance.getrandbits(width) for _ in range(depth)], width)
            write_slices(folder)

    parameters: dict[str, Any] = {"Width": width, "Depth": depth, "Style": style}
    environment = {"FILE": file} if file else {}
    if file:
        parameters["File"] = as_sv_literal(file)
    run_tb("td_ram", parameters, roms=contents, environment=environment, files=files)


@given(st.lists(st.tuples(st.integers(0, 7), st.integers(0, 255)), max_size=40))
def test_a_word_is_the_last_one_written_there(writes: Any) -> None:
    words, _ = ram([None] * 8, [(True, place, word, False, 0) for place, word in writes])
    assert {place: word for place, word in enumerate(words) if word is not None} == dict(writes)


def test_read_data_stays_between_reads() -> None:
    clocks = [(True, 0, 5, False, 0), (False, 0, 0, True, 0), (True, 0, 6, False, 0), (False, 0, 0, True, 0)]
    assert ram([None], clocks)[1] == [None, 5, 5, 6]
