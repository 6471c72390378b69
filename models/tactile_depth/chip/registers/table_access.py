# SPDX-License-Identifier: Apache-2.0
"""Behavioural model of hdl/registers/table_access.sv: entries of the tables, one after another."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from tactile_depth.chip.registers.register_map import REGISTERS, WORD, WORD_BITS

INDEX, HIGH, LOW, SIZE = "TABLE_INDEX", "TABLE_HIGH", "TABLE_LOW", "TABLE_SIZE"
PORTS = tuple(name for name, register in REGISTERS.items() if any(f.access == "port" for f in register.fields))
"""Registers whose reads are answered by a table."""


@dataclass
class TableAccess:
    """State of the access.

    Attributes
    ----------
    sizes : mapping
        Number of entries of each table by its code in TABLE_SELECT; 0: the build does not have the table.
    values : dict
        TABLE_INDEX, and TABLE_HIGH as it was written.
    """

    sizes: Mapping[int, int]
    values: dict[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.reset()

    @property
    def index_width(self) -> int:
        """Bits of TABLE_INDEX."""
        return (max(self.sizes.values()) - 1).bit_length()

    def reset(self) -> None:
        """Set index and upper word to 0."""
        self.values.update({INDEX: 0, HIGH: 0})

    def has_entry(self, select: int) -> bool:
        """Return True if the table has the entry TABLE_INDEX."""
        return self.values[INDEX] < self.sizes.get(select, 0)

    def refuses(self, name: str, mask: int, select: int, closed: int) -> bool:
        """Return True for a write of an entry that cannot be made."""
        return name == LOW and not (self.has_entry(select) and mask == WORD and not closed >> select & 1)

    def write(self, name: str, ones: int, mask: int, select: int) -> tuple[int, int, int, int] | None:
        """Write the bits of `mask`; return table, index, upper and lower word of the entry that is written."""
        if name == LOW:
            entry = (select, self.values[INDEX], self.values[HIGH], ones)
            self._move_on(select)
            return entry
        if name in (INDEX, HIGH):
            width = self.index_width if name == INDEX else WORD_BITS
            self.values[name] = (ones | self.values[name] & ~mask) & ((1 << width) - 1)
        return None

    def read(self, name: str, select: int) -> int | None:
        """Return the index of the entry that a read of TABLE_HIGH or TABLE_LOW asks for; None if there is none."""
        if not self.has_entry(select):
            return None
        index = self.values[INDEX]
        if name == LOW:
            self._move_on(select)
        return index

    def _move_on(self, select: int) -> None:
        self.values[INDEX] = (self.values[INDEX] + 1) % self.sizes[select]
