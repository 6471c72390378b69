# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/common/td_banked_table.sv."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from tactile_depth.chip.common.td_parity_ram import checked, is_odd


class BankedTable:
    """Two banks of words: frames read one; the other is written and read by others.

    Attributes
    ----------
    banks : list of list of int
        As they are stored, None where one is not known.
    in_use : int
        Bank that frames read.
    named : int
        Bank of a frame that has begun and does not read yet; None without one.
    wanted : int
        Bank that software wants, in the clock before.
    word, free_word : int
        Words that were read; None where none counts.
    """

    def __init__(self, words: Sequence[int | None], width: int = 0) -> None:
        """Hold words; those of `width` bits have their parity on top."""
        self.banks = [[*words], [*words]]
        self.width = width
        self._checked: int | None = None
        self._flipped: int | None = None
        self.in_use = self.wanted = 0
        self.named: int | None = None
        self.word: int | None = None
        self.free_word: int | None = None

    def settled(self, wanted: int) -> bool:
        """Return whether no change-over is due."""
        return wanted == self.in_use and self.named in (None, wanted)

    def clock(self, **pins: Any) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        words = {"read_word": self.word, "free_word": self.free_word}
        if self.width:
            words = {name: word if word is None else word & (1 << self.width) - 1 for name, word in words.items()}
        out = {"table_in_use": self.in_use, **words, "flipped": self._flipped if self.width else 0}
        self._flipped, self._checked = is_odd(self._checked), self.word
        free = self.banks[1 - self.in_use]
        if pins["en"]:
            if pins["change"] and self.named is not None:
                self.in_use, self.named = self.named, None
            if pins["frame_start"]:
                self.named = pins["table_bank"]
            self.word = self.banks[self.in_use][pins["read_address"]] if pins["read"] else None
        self.free_word = self.banks[1 - self.in_use][pins["free_read_address"]] if pins["free_read"] else None
        if pins["free_write"]:
            word = pins["free_write_word"]
            free[pins["free_write_address"]] = checked(word, self.width) if self.width else word
        self.wanted = pins["table_bank"]
        if pins["rst"]:
            self.in_use, self.named, self.word, self.free_word = self.wanted, None, None, None
        return out
