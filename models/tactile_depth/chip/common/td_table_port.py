# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/common/td_table_port.sv."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

WORD_BITS = 32  # of TABLE_HIGH and TABLE_LOW


@dataclass
class TablePort:
    """Port of one table.

    Attributes
    ----------
    words : int
        Words of an entry: 1, or 2 with the upper one in TABLE_HIGH. An entry is {upper, lower}.
    entries : int
        Entries side by side in a word of the table's memory, which the lowest bits of the index tell apart.
    write, read, index, word : int
        Outputs to the table; `write` but for a reset in its cycle.
    """

    select: int
    index_width: int
    width: int
    words: int = 1
    entries: int = 1
    signed: bool = False
    write: int = 0
    read: int = 0
    index: int = 0
    word: int = 0
    _fetched: int | None = None
    _selected: int = 0
    _entry: int | None = None

    def clock(self, command: Mapping[str, int], free_word: int, reset: int) -> None:
        """Take a cycle's members of `table_command_t` and the entries that the table shows."""
        names = int(command["select"] == self.select)
        if self._fetched is not None:
            self._entry = free_word >> self._fetched * self.words * self.width & (1 << self.words * self.width) - 1
        self._fetched = self.index % (1 << (self.entries - 1).bit_length()) if self.read else None
        self._selected = names
        self.write, self.read = (int(names and not reset and command[access]) for access in ("write", "read"))
        mask = (1 << self.width) - 1
        self.index = command["index"] & (1 << self.index_width) - 1
        self.word = command["low"] & mask | (self.words - 1) * ((command["high"] & mask) << self.width)

    def answer(self) -> dict[str, int] | None:
        """Return the members of `table_answer_t`, None before the first entry."""
        if not self._selected:
            return {"high": 0, "low": 0}
        return None if self._entry is None else answered(self._entry, self.width, self.words, self.signed)


def answered(entry: int, width: int, words: int = 1, signed: bool = False) -> dict[str, int]:
    """Return the members of `table_answer_t` for an entry of `words` words of `width` bits."""
    answer = {"high": 0, "low": 0}
    for place, member in enumerate(("low", "high")[:words]):
        word = entry >> place * width & (1 << width) - 1
        extension = signed * (word >> width - 1) * (1 << width)
        answer[member] = (word - extension) & (1 << WORD_BITS) - 1
    return answer
