# SPDX-License-Identifier: Apache-2.0
"""rom: RTL against the file it reads, small enough for LUTs and not."""

from pathlib import Path

from tactile_depth.chip.common.td_rom import rom
from tactile_depth.chip.rom_files import pack, write_words


def test_addresses_read_their_words() -> None:
    assert rom([7, 8, 9], [2, 0, 2, 1]) == [9, 7, 9, 8]


def test_fields_are_packed_first_on_top_in_two_s_complement() -> None:
    assert pack(([-1, 3], [1, -8]), 4) == [0xF1, 0x38]  # type: ignore[arg-type]


def test_words_are_one_line_each_with_all_their_digits(tmp_path: Path) -> None:
    write_words(tmp_path / "words.hex", [0, 0x1FF], 9)
    assert (tmp_path / "words.hex").read_text() == "000\n1ff\n"
