# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/link/bank_choice.sv."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

BANKS = frozenset((0, 1))


class Seen(NamedTuple):
    """Outputs in a clock; a bank is None where it does not count."""

    write_bank: int | None
    waiting: bool
    read_bank: int | None
    replaced: bool


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
        keep: bool = True,
        write_begin: bool = False,
        write_end: bool = False,
        publish: bool = False,
        take: bool = False,
        done: bool = False,
    ) -> Seen:
        """Advance by one clock edge; return the outputs before it."""
        waiting, read_bank = self.ready is not None, self.read
        if done:
            self.read = None
        if take:
            self.read, self.ready = self.ready, None
        before = {self.whole, self.ready} - {None}
        if write_begin and self.written is None:
            self.written = self._free()
        write_bank = self.written
        if write_end:
            self.whole, self.written = self.written, None
        if publish and self.whole is not None:
            self.ready, self.whole = self.whole, None
        if write_begin:
            self.whole = None if self.whole == write_bank else self.whole
            self.ready = None if self.ready == write_bank else self.ready
        if not keep:
            self.ready = None
        return Seen(write_bank, waiting, read_bank, keep and not before <= {self.whole, self.ready})

    def _free(self) -> int:
        """Return the bank in which a frame begins."""
        if self.read is not None:
            return 1 - self.read
        if self.whole is not None and self.ready is not None:
            return self.ready  # the older one
        return min(BANKS - {self.whole, self.ready})

    def reset(self) -> None:
        """Advance by one clock edge in reset."""
        self.written = self.whole = self.ready = self.read = None
