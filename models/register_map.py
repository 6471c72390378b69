# SPDX-License-Identifier: Apache-2.0
"""The map of the AXI4-Lite registers, for models, testbenches and commands.

It is written down in registers/tactile_depth.rdl. `make registers` compiles that into the JSON read here, so that a run
needs no SystemRDL tools. What the registers do is modelled in models/axil_registers.py.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FILE = ROOT / "registers" / "tactile_depth.json"

WORD_BITS = 32
ACCESSES = {
    "ro": "read-only",
    "rw": "read and written",
    "w1c": "read; a written 1 clears the bit, a written 0 leaves it",
    "w1s": "read; a written 1 sets the bit, a written 0 leaves it",
    "pulse": "a written 1 does something once; reads 0",
    "port": "reads and writes go to what lies behind the register",
}


@dataclass(frozen=True)
class Field:
    """Bits `high` to `low` of a register.

    Attributes
    ----------
    access : str
        One of `ACCESSES`.
    reset : int or None
        Value after reset; None: given by the parameters of the build, or by what it shows.
    signed : bool
        Two's complement.
    values : mapping
        Name to code, of a field that chooses.
    """

    name: str
    low: int
    high: int
    access: str
    reset: int | None
    signed: bool
    values: Mapping[str, int]
    description: str

    @property
    def width(self) -> int:
        return self.high - self.low + 1

    @property
    def mask(self) -> int:
        """Ones at the field's bits of the register."""
        return (1 << self.high + 1) - (1 << self.low)


@dataclass(frozen=True)
class Register:
    """One 32-bit register; `offset` in bytes, a multiple of 4. One that is a single number has the field `value`.
    `made_elsewhere`: hdl/axil_registers.sv gets it as one word."""

    name: str
    offset: int
    description: str
    made_elsewhere: bool
    fields: tuple[Field, ...]

    @property
    def writable(self) -> bool:
        """Whether a write is answered with OKAY."""
        return any(field.access != "ro" for field in self.fields)

    @property
    def reset(self) -> int | None:
        """The word after reset; None: the fields of the register do not all have a value of their own."""
        word = 0
        for field in self.fields:
            if field.reset is None:
                return None
            word |= field.reset << field.low
        return word

    def mask(self, *accesses: str) -> int:
        """Ones at the bits of fields of these accesses, of all fields if none is named."""
        return sum(field.mask for field in self.fields if not accesses or field.access in accesses)

    def field(self, name: str) -> Field:
        """The field of that name; KeyError names those there are."""
        for field in self.fields:
            if field.name == name:
                return field
        raise KeyError(f"{self.name} has no field {name}: it has {', '.join(f.name for f in self.fields)}")

    def unpack(self, word: int) -> dict[str, int]:
        """Field name to value, unsigned, for a word that was read."""
        return {field.name: (word & field.mask) >> field.low for field in self.fields}

    def pack(self, **values: int) -> int:
        """The word with these fields, all others zero.

        Raises
        ------
        ValueError
            A value does not fit its field.
        """
        word = 0
        for name, value in values.items():
            field = self.field(name)
            if not 0 <= value < 1 << field.width:
                raise ValueError(f"{self.name}.{name}={value} does not fit: accepted are 0 to {(1 << field.width) - 1}")
            word |= value << field.low
        return word


_READ = json.loads(FILE.read_text())

ADDRESS_WIDTH: int = _READ["address_width"]  # bits of a byte address
MAP = tuple(
    Register(**register | {"fields": tuple(Field(**field) for field in register["fields"])})
    for register in _READ["registers"]
)
REGISTERS = {register.name: register for register in MAP}
TABLES = REGISTERS["TABLE_SELECT"].field("select").values  # name to code
