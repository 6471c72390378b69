# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/common/td_repeat_check.sv: whether words of a frame are those of the frame before."""

from __future__ import annotations

SIGNATURE_WIDTH = 19


def signature(words: list[int]) -> int:
    """Return the signature of the words of a frame."""
    mask, now = (1 << SIGNATURE_WIDTH) - 1, 0
    for word in words:
        now = (now << 1 | now >> SIGNATURE_WIDTH - 1) & mask
        while word:
            now, word = now ^ word & mask, word >> SIGNATURE_WIDTH
    return now


class RepeatCheck:
    """State between two clocks.

    Attributes
    ----------
    words : list of int or None
        Words so far of the frame that comes, None between frames.
    bank : int
        Bank of that frame, or of the last one.
    """

    def __init__(self) -> None:
        self._reset()

    def _reset(self) -> None:
        self.words: list[int] | None = None
        self.bank = 0
        self._before = -1  # signature of the frame before; -1: nothing to compare with
        self._ended: tuple[int, int] | None = None  # signatures of the frame before and of this one
        self._differs = False

    def clock(self, *, rst: int, en: int, in_valid: int, **pins: int) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it."""
        out = {"differs": int(self._differs)}
        self._differs = self._ended is not None and self._ended[0] not in (-1, self._ended[1])
        self._ended = None
        if en and in_valid:
            if pins["in_first"]:
                before = self._before if self.words is None else -1
                self._before = before if pins["in_bank"] == self.bank else -1
                self.bank, self.words = pins["in_bank"], []
            assert self.words is not None, "no frame has begun"
            self.words.append(pins["in_data"])
            if pins["in_last"]:
                now = signature(self.words)
                self._ended, self._before, self.words = (self._before, now), now, None
        if rst:
            self._reset()
        return out
