# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/contact/flip_marks.sv: which records are of frames that a flipped bit may have damaged."""

from __future__ import annotations


class FlipMarks:
    """State between two clocks; `records` is the number that a flip marks."""

    def __init__(self, records: int) -> None:
        self.records = records
        self._reset()

    def _reset(self) -> None:
        self._begun, self._to_mark, self._flipped, self._counts = False, 0, False, False

    def clock(self, *, rst: int, flipped: int, record_valid: int) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it."""
        now = bool(flipped and self._begun)
        out = {"marked": int(now or self._to_mark > 0), "found": int(self._counts)}
        self._counts, self._flipped = now and not self._flipped, now
        self._to_mark = self.records if now else max(self._to_mark - record_valid, 0)
        self._begun |= bool(record_valid)
        if rst:
            self._reset()
        return out
