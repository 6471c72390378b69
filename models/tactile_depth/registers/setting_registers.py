# SPDX-License-Identifier: Apache-2.0
"""Behavioural model of hdl/registers/setting_registers.sv: registers that software alone writes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from tactile_depth.registers.register_map import MAP

SETTINGS = {register.name: register for register in MAP if any(f.setting for f in register.fields)}
"""Registers with settings by name, in the order of their numbers."""
MASKS = {name: sum(f.mask for f in register.fields if f.setting) for name, register in SETTINGS.items()}
RESETS = {name: sum((f.reset or 0) << f.low for f in r.fields if f.setting) for name, r in SETTINGS.items()}


@dataclass
class SettingRegisters:
    """State of the registers.

    Attributes
    ----------
    resets : mapping
        Name to value after a reset, of the registers for which the build gives it.
    values : dict
        Name to word.
    """

    resets: Mapping[str, int] = field(default_factory=dict)
    values: dict[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Set every register to its reset value."""
        self.values.update({**RESETS, **self.resets})

    def write(self, name: str, ones: int, mask: int) -> None:
        """Write the bits of `mask`; `ones` is 0 in all others. A register without settings does not change."""
        if name in SETTINGS:
            self.values[name] = (ones | self.values[name] & ~mask) & MASKS[name]
