# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/common/td_parity_ram.sv."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any


def is_odd(word: int | None) -> int | None:
    """Return 1 for a word with an odd number of ones, else 0; None for one that is not known."""
    return None if word is None else word.bit_count() % 2


def checked(word: int, width: int) -> int:
    """Return a word of `width` bits with its parity on top."""
    return word | word.bit_count() % 2 << width


class ParityRam:
    """Words with a parity bit on top, and the register behind them.

    Attributes
    ----------
    words : list of int
        As they are stored, None where one is not known.
    """

    def __init__(self, words: Sequence[int | None], width: int, latency: int, parity: bool) -> None:
        self.words, self.width, self.latency, self.parity = [*words], width, latency, parity
        self._read: int | None = None
        self._registered: int | None = None
        self._checked: int | None = None
        self._flipped: int | None = None

    def clock(self, **pins: Any) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one is not known."""
        word = self._registered if self.latency == 2 else self._read
        out = {"read_data": word if word is None else word & (1 << self.width) - 1}
        out["flipped"] = self._flipped if self.parity else 0
        self._flipped, self._checked = is_odd(self._checked), word
        if pins["en"]:
            self._registered = self._read
        if pins["read_en"]:
            self._read = self.words[pins["read_address"]]
        if pins["write_en"]:
            data = pins["write_data"]
            self.words[pins["write_address"]] = checked(data, self.width) if self.parity else data
        return out
