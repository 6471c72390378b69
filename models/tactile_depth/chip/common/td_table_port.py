# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/common/td_table_port.sv."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

WORD_BITS = 32  # of TABLE_HIGH and TABLE_LOW
INDEX_BITS = 24


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
    signed: int = 0
    write: int = 0
    read: int = 0
    index: int = 0
    word: int = 0
    _fetched: int | None = None
    _selected: int = 1
    _entry: int | None = None

    def clock(self, *, rst: int, table_command: int, free_word: int | None) -> dict[str, Any]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        out: dict[str, Any] = {"write": self.write and not rst, "read": self.read}
        out |= {"index": self.index, "word": self.word, "table_answer": 0}
        if self._selected:
            entry = self._entry
            out["table_answer"] = None if entry is None else answered(entry, self.width, self.words, self.signed)
        if self._fetched is not None:
            size = self.words * self.width
            self._entry = None if free_word is None else free_word >> self._fetched * size & (1 << size) - 1
        self._fetched = self.index % (1 << (self.entries - 1).bit_length()) if self.read else None
        high, low = (table_command >> place & (1 << self.width) - 1 for place in (WORD_BITS, 0))
        command = table_command >> 2 * WORD_BITS
        self._selected = command >> INDEX_BITS & 3 == self.select
        self.write, self.read = (
            int(self._selected and not rst and command >> INDEX_BITS + place & 1) for place in (3, 2)
        )
        self.index = command & (1 << self.index_width) - 1
        self.word = low | (self.words - 1) * (high << self.width)
        return out


def answered(entry: int, width: int, words: int = 1, signed: int = 0) -> int:
    """Return `table_answer_t` for an entry of `words` words of `width` bits."""
    answer = 0
    for place in range(words):
        word = entry >> place * width & (1 << width) - 1
        extension = signed * (word >> width - 1) * (1 << width)
        answer |= ((word - extension) & (1 << WORD_BITS) - 1) << place * WORD_BITS
    return answer
