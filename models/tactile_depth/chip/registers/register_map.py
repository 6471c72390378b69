# SPDX-License-Identifier: Apache-2.0
"""The maps of the AXI4-Lite registers, for models, testbenches and commands.

The sources are registers/tactile_depth.rdl and registers/camera.rdl. `make registers` compiles them into the JSON files
that are read here, so that a run needs no SystemRDL tools; they leave out what has its default.
models/tactile_depth/chip/registers/axil_registers.py and models/tactile_depth/chip/camera/camera_registers.py model the
behaviour of the registers.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from importlib import resources
from typing import Any

WORD_BITS = 32
WORD = (1 << WORD_BITS) - 1
"""Word of all ones."""
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
        Value after reset; None if the parameters of the build or a live input determine it.
    signed : bool
        True for two's complement.
    setting : bool
        True if software alone writes the field, and it holds what was written.
    values : mapping
        Name to code, for a field that selects one of several values.
    """

    name: str
    low: int
    high: int
    access: str
    reset: int | None = None
    signed: bool = False
    setting: bool = False
    values: Mapping[str, int] = field(default_factory=dict)

    @cached_property
    def width(self) -> int:
        return self.high - self.low + 1

    @cached_property
    def mask(self) -> int:
        """Mask of the field's bits in the register."""
        return (1 << self.high + 1) - (1 << self.low)


@dataclass(frozen=True)
class Register:
    """One 32-bit register.

    Attributes
    ----------
    offset : int
        Byte address, a multiple of 4.
    fields : tuple of Field
        A register that holds a single number has one field, `value`.
    """

    name: str
    offset: int
    fields: tuple[Field, ...]

    @cached_property
    def writable(self) -> bool:
        """True if a write is answered with OKAY."""
        return any(field.access != "ro" for field in self.fields)

    @property
    def reset(self) -> int | None:
        """Word after reset; None if a field has no fixed reset value."""
        word = 0
        for each in self.fields:
            if each.reset is None:
                return None
            word |= each.reset << each.low
        return word

    def mask(self, *accesses: str) -> int:
        """Return a mask of the bits of fields with these accesses, of all fields if none is named."""
        return sum(field.mask for field in self.fields if not accesses or field.access in accesses)

    def field(self, name: str) -> Field:
        """Return the field of that name; raise KeyError with the accepted names otherwise."""
        for each in self.fields:
            if each.name == name:
                return each
        raise KeyError(f"{self.name} has no field {name}: it has {', '.join(f.name for f in self.fields)}")

    def unpack(self, word: int) -> dict[str, int]:
        """Return field name to unsigned value of a word that was read."""
        return {field.name: (word & field.mask) >> field.low for field in self.fields}

    def pack(self, **values: int) -> int:
        """Return the word with these field values; all other fields are zero.

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


def _read(name: str) -> Any:
    return json.loads(resources.files(__package__).joinpath(name).read_text())  # also from a .zip


def _registers(read: Any) -> tuple[Register, ...]:
    return tuple(
        Register(**register | {"fields": tuple(Field(**field) for field in register["fields"])})
        for register in read["registers"]
    )


_PIPELINE = _read("register_map.json")
ADDRESS_WIDTH: int = _PIPELINE["address_width"]  # bits of a byte address
MAP = _registers(_PIPELINE)
REGISTERS = {register.name: register for register in MAP}
TABLES = REGISTERS["TABLE_SELECT"].field("select").values  # name to code
CAMERA_MAP = _registers(_read("camera_map.json"))
CAMERA_REGISTERS = {register.name: register for register in CAMERA_MAP}
