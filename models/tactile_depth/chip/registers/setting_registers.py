# SPDX-License-Identifier: Apache-2.0
"""Behavioural model of hdl/registers/setting_registers.sv: registers that software alone writes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from tactile_depth.chip.registers.register_map import MAP, Register


def settings(registers: Iterable[Register]) -> dict[str, Register]:
    """Return the registers with settings by name, in the order of their numbers."""
    return {register.name: register for register in registers if any(f.setting for f in register.fields)}


def masks(registers: Iterable[Register]) -> dict[str, int]:
    """Return the bits of each register that are settings."""
    return {name: sum(f.mask for f in r.fields if f.setting) for name, r in settings(registers).items()}


def resets(registers: Iterable[Register]) -> dict[str, int]:
    """Return the value of each register with settings after a reset; 0 for fields that the build gives."""
    found = settings(registers).items()
    return {name: sum((f.reset or 0) << f.low for f in r.fields if f.setting) for name, r in found}


SETTINGS, MASKS, RESETS = settings(MAP), masks(MAP), resets(MAP)


@dataclass
class SettingRegisters:
    """State of the registers.

    Attributes
    ----------
    resets : mapping
        Name to value after a reset, of the registers for which the build gives it.
    values : dict
        Name to word.
    registers : sequence of Register
        The map.
    """

    resets: Mapping[str, int] = field(default_factory=dict)
    values: dict[str, int] = field(default_factory=dict)
    registers: tuple[Register, ...] = MAP

    def __post_init__(self) -> None:
        self._masks = masks(self.registers)
        self.reset()

    def reset(self) -> None:
        """Set every register to its reset value."""
        self.values.update({**resets(self.registers), **self.resets})

    def write(self, name: str, ones: int, mask: int) -> None:
        """Write the bits of `mask`; `ones` is 0 in all others. A register without settings does not change."""
        if name in self._masks:
            self.values[name] = (ones | self.values[name] & ~mask) & self._masks[name]
