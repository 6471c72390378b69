# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/link/bank_choice.sv."""

from __future__ import annotations

from dataclasses import dataclass

BANKS = frozenset((0, 1))


@dataclass
class BankChoice:
    """State between two clock edges: the bank of each frame, or None.

    Attributes
    ----------
    written : int or None
        A frame is being written into it.
    whole : int or None
        Its frame is whole, and not ready.
    ready : int or None
        Its frame waits.
    read : int or None
        Its frame is being read.
    """

    written: int | None = None
    whole: int | None = None
    ready: int | None = None
    read: int | None = None

    def clock(
        self,
        *,
        rst: int = 0,
        keep: int = 1,
        write_begin: int = 0,
        write_end: int = 0,
        publish: int = 0,
        take: int = 0,
        done: int = 0,
    ) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None for a bank that does not count."""
        out: dict[str, int | None] = {"waiting": self.ready is not None, "reading": self.read is not None}
        out["read_bank"] = self.read
        if done:
            self.read = None
        if take:
            self.read, self.ready = self.ready, None
        before = {self.whole, self.ready} - {None}
        if write_begin and self.written is None:
            self.written = self._free()
        write_bank = out["write_bank"] = self.written
        if write_end:
            self.whole, self.written = self.written, None
        if publish and self.whole is not None:
            self.ready, self.whole = self.whole, None
        if write_begin:
            self.whole = None if self.whole == write_bank else self.whole
            self.ready = None if self.ready == write_bank else self.ready
        if not keep:
            self.ready = None
        out["replaced"] = keep and not before <= {self.whole, self.ready}
        if rst:
            self.written = self.whole = self.ready = self.read = None
        return out

    def _free(self) -> int:
        """Return the bank in which a frame begins."""
        if self.read is not None:
            return 1 - self.read
        if self.whole is not None and self.ready is not None:
            return self.ready  # the older one
        return min(BANKS - {self.whole, self.ready})
