# SPDX-License-Identifier: Apache-2.0
"""Behavioural model of hdl/registers/table_banks.sv: banks of the tables, change-overs, and captures."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from tactile_depth.chip.registers.register_map import REGISTERS

COMMIT = REGISTERS["TABLE_COMMIT"]
CAPTURES = {"reference": REGISTERS["REFERENCE_CAPTURE"], "zero": REGISTERS["ZERO_CAPTURE"]}
"""Registers that start a capture, by the table that is captured."""


def bits(tables: Collection[str]) -> int:
    """Return the bits of tables with these names."""
    return COMMIT.pack(**dict.fromkeys(tables, 1))


@dataclass
class TableBanks:
    """State of the banks, bit by bit.

    Attributes
    ----------
    present : int
        Tables that the build has.
    bank : int
        Bank of each table; a reset leaves it.
    requested : int
        Tables that change over with the next frame.
    """

    present: int
    bank: int = 0
    requested: int = 0
    _committed: int = 0

    def reset(self) -> None:
        """Forget the requests that no frame has taken."""
        self.requested = self._committed = 0

    def pending(self, in_use: int) -> int:
        """Return TABLE_COMMIT: the tables that have not changed over, or change over with the next frame."""
        return self.requested | (self.bank ^ in_use) & self.present

    def closed(self, in_use: int, capturing: Collection[str]) -> int:
        """Return the tables that the bus can neither write nor commit."""
        return self.pending(in_use) | bits(capturing)

    def wanted(self, frame_start: bool) -> int:
        """Return the bank requested for each table in a cycle with or without the start of a frame."""
        return self.bank ^ self.requested if frame_start else self.bank

    def refuses(self, name: str, ones: int, in_use: int, ending: Collection[str]) -> bool:
        """Return True for a start of a capture that cannot be made.

        Parameters
        ----------
        name : str
            Register that is written.
        ones : int
            Data, 0 in bytes without strobe.
        in_use : int
            Bank that each table uses.
        ending : collection of str
            Tables in the last cycle of their capture.
        """
        table = self.started(name, ones)
        due = table == "zero" and (self.pending(in_use) & bits({table}) or table in ending)
        return table is not None and bool(not self.present & bits({table}) or due)

    @staticmethod
    def started(name: str, ones: int) -> str | None:
        """Return the table whose capture a write of this register starts."""
        for table, register in CAPTURES.items():
            if register.name == name and ones & register.field("start").mask:
                return table
        return None

    def write(self, name: str, ones: int, in_use: int, capturing: Collection[str]) -> None:
        """Take a write, which takes effect with the next call of `clock`."""
        if name == COMMIT.name:
            self._committed |= ones & self.present & ~self.closed(in_use, capturing)

    def clock(self, frame_start: bool, captured: Collection[str]) -> None:
        """Take the end of one cycle; `captured` are the tables whose capture has ended in it."""
        self.bank = self.wanted(frame_start)
        if frame_start:
            self.requested = 0
        # A frame that starts in the cycle of a request still uses the table before.
        self.requested |= self._committed | bits(captured) & self.present
        self._committed = 0
