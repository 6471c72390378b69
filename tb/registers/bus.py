# SPDX-License-Identifier: Apache-2.0
"""Choices of the pins of AXI4-Lite, and of those between axil_port and a core of registers, for benches in lockstep."""

import random
from typing import Any

import cocotb
from cocotb.handle import Immediate

from tactile_depth.chip.registers.axil_port import strobed_bits
from tactile_depth.chip.registers.register_map import CAMERA_REGISTERS, REGISTERS
from tb.lockstep import WORD, Pins

OFFSET = {name: register.offset for name, register in {**REGISTERS, **CAMERA_REGISTERS}.items()}
NAME_AT = {offset: name for name, offset in OFFSET.items()}
STROBES = [strobed_bits(strobe) for strobe in (15, *range(15))]
CHANNELS = ("s_axil_aw", "s_axil_w", "s_axil_ar")
"""Streams into a port on AXI4-Lite."""
PINS = {
    **dict.fromkeys((f"s_axil_{pin}" for pin in ("awaddr", "wdata", "araddr")), WORD),
    "s_axil_wstrb": range(15, -1, -1),
    **dict.fromkeys((f"s_axil_{pin}" for pin in ("awvalid", "wvalid", "bready", "arvalid", "rready")), 1.0),
}
"""Choices of the pins of a client on AXI4-Lite."""


def begin_low(dut: Any) -> None:
    """Set the clock low before the first step of Verilator, in which a clock that is high at random would rise.

    The pins are random in that step too, and the banks of tables change with them: only cold_rst clears these.
    """
    dut.clk.value = Immediate(0)


class Bus:
    """The pins between axil_port and a core, which has registers of these names.

    Attributes
    ----------
    choices : mapping
        What each pin may be; `drive` is to make them legal.
    """

    def __init__(self, dut: Any, *names: str) -> None:
        self.chance, self.own = random.Random(cocotb.RANDOM_SEED), [OFFSET[name] for name in names]
        pins = {"write": 1.0, "write_offset": self.own, "write_ones": WORD, "write_mask": STROBES}
        self.choices = {pin: pins[pin] for pin in pins if hasattr(dut, pin)} | {"read_offset": self.own}

    def drive(self, pins: Pins) -> None:
        """Clear bytes without strobe. Address registers, and as often what differs from one in one bit."""
        pins["write_ones"] &= pins.get("write_mask", -1)
        for pin in ("write_offset", "read_offset"):
            pins[pin] = self.chance.choice(self.own) ^ (self.chance.getrandbits(1) << self.chance.randrange(32))
