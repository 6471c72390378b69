# SPDX-License-Identifier: Apache-2.0
"""rom: RTL against the file it reads, small enough for LUTs and not."""

import random
from pathlib import Path
from typing import Any

from tactile_depth.chip.common.td_rom import rom
from tactile_depth.chip.rom_files import pack, write_words
from tb.structures import ICARUS, VERILATOR, Structure
from tests.rtl import test_rtl as test_rtl


def built(width: int, depth: Any, style: int, **runs: Any) -> Structure:
    chance = random.Random(depth)
    words = [chance.getrandbits(width) for _ in range(depth)]
    return Structure(
        {"Width": width, "Depth": depth, "Style": style},
        roms=lambda folder: write_words(folder / "rom.hex", words, width),
        **runs,
    )


STRUCTURES = (
    built(54, 128, 3, on=VERILATOR),
    built(10, 36, 3, on=ICARUS, mutants=True),
    built(72, 33, 3),
    built(54, 128, 0),
    built(10, 36, 1),
)
REFUSED = {
    "Depth=1": "Depth_must_be_at_least_2",
}
NO_PROOF = "one read register and no other state; its contents and addresses are proven of those that use it"


def test_addresses_read_their_words() -> None:
    assert rom([7, 8, 9], [2, 0, 2, 1]) == [9, 7, 9, 8]


def test_fields_are_packed_first_on_top_in_two_s_complement() -> None:
    assert pack(([-1, 3], [1, -8]), 4) == [0xF1, 0x38]  # type: ignore[arg-type]


def test_words_are_one_line_each_with_all_their_digits(tmp_path: Path) -> None:
    write_words(tmp_path / "words.hex", [0, 0x1FF], 9)
    assert (tmp_path / "words.hex").read_text() == "000\n1ff\n"
