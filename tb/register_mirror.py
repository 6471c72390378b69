# SPDX-License-Identifier: Apache-2.0
"""Values of registers that software writes, followed at the AXI4-Lite pins."""

from types import SimpleNamespace
from typing import Any

from tactile_depth.chip.registers.axil_port import Response, strobed_bits
from tactile_depth.chip.registers.register_map import MAP, REGISTERS
from tb.pins import unsigned

OFFSETS = {register.offset: register.name for register in MAP}


class RegisterMirror:
    """Words of some registers, as the cores see them in the cycle of the latest call of `clock`.

    A write takes effect at the clock edge at which `bvalid` rises. Only registers that read back the written word can
    be followed.
    """

    def __init__(self, dut: Any, *names: str) -> None:
        self.names = names
        names_of_pins = ["bvalid", "bresp", "awvalid", "awready", "awaddr", "wvalid", "wready", "wdata", "wstrb"]
        self.pins = SimpleNamespace(**{pin: unsigned(getattr(dut, f"s_axil_{pin}")) for pin in names_of_pins})
        self.address = self.data = self.strobe = 0  # address and data of the latest write
        self.reset()

    def reset(self) -> None:
        """Return to the values after a reset."""
        self.words = {
            name: sum((field.reset or 0) << field.low for field in REGISTERS[name].fields) for name in self.names
        }
        self.answered = False

    def clock(self) -> None:
        """Take one clock edge out of reset."""
        pins = self.pins
        answers = bool(pins.bvalid())
        name = OFFSETS.get(self.address & ~3) if answers and not self.answered else None
        if name in self.words and pins.bresp() == Response.OKAY:
            mask = strobed_bits(self.strobe)
            self.words[name] = (self.data & mask | self.words[name] & ~mask) & REGISTERS[name].mask("rw")
        self.answered = answers
        if pins.awvalid() and pins.awready():
            self.address = pins.awaddr()
        if pins.wvalid() and pins.wready():
            self.data, self.strobe = pins.wdata(), pins.wstrb()
