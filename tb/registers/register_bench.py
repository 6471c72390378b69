# SPDX-License-Identifier: Apache-2.0
"""Bench of a core of registers behind axil_port: one call per cycle sets all inputs and compares all outputs.

A core has the inputs write, write_offset, write_ones, write_mask (some), read_offset and the output read_data.
"""

from __future__ import annotations

import random
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import cocotb
from cocotb.triggers import RisingEdge

from tactile_depth.chip.registers.axil_port import strobed_bits
from tactile_depth.chip.registers.register_map import ADDRESS_WIDTH, MAP, WORD, Register
from tb.pins import Driver, by_name
from tb.stream import REGRESS, start_clock

RANDOM_CLOCKS = 10_000 if REGRESS else 2_000
WHOLE = 0xF  # every byte is strobed
BUS = ("write", "write_offset", "write_ones", "write_mask", "read_offset", "rst")


class RegisterBench:
    """Driver of a core, one cycle at a time; the subclass of a core has its model.

    Attributes
    ----------
    random : random.Random
        Seeded by cocotb.
    """

    idle: Mapping[str, int] = MappingProxyType({})  # inputs beside the bus, while a test sets no other value
    registers: tuple[Register, ...] = MAP

    def __init__(self, dut: Any) -> None:
        self.dut, self.clocks = dut, 0
        self.drive, self.pin, self.edge = Driver(dut), by_name(dut), RisingEdge(dut.clk)
        self.driven = [name for name in (*BUS, *self.idle) if hasattr(dut, name)]
        self.can_refuse = hasattr(dut, "write_refused")
        self.offset = {register.name: register.offset for register in self.registers}
        self.name_at = {offset: name for name, offset in self.offset.items()}
        self.random = random.Random(cocotb.RANDOM_SEED)
        start_clock(dut.clk)

    # A core's own: its model.

    def word(self, name: str) -> int:
        """Return the word that a read of a register shows, 0 for a register of another core."""
        raise NotImplementedError

    def refuses(self, name: str, ones: int, mask: int) -> bool:
        """Return True if a write is refused, for cores with the pin write_refused."""
        return False

    def outputs(self) -> dict[str, int]:
        """Return all other outputs in this cycle."""
        return {}

    def step(self, write: tuple[str, int, int] | None) -> None:
        """Take the clock edge with the accepted write of this cycle: register, ones, mask."""
        raise NotImplementedError

    def reset(self) -> None:
        """Take a clock edge in reset."""
        raise NotImplementedError

    # The pins.

    async def start(self) -> None:
        """Hold the reset for two clocks, with all inputs idle."""
        self.drive(**{name: self.idle.get(name, 0) for name in self.driven} | {"rst": 1})
        for _ in range(2):
            await self.edge
        self.reset()

    def expect(self, name: str, expected: int) -> None:
        got = self.pin(name)
        assert got == expected, f"clock {self.clocks}: {name} is {got:#x}, expected {expected:#x}"

    async def clock(
        self, write: tuple[str | int, int, int] | None = None, read_at: str | int = 0, rst: bool = False, **inputs: int
    ) -> int:
        """Set the inputs of one cycle, compare its outputs, and return read_data.

        Parameters
        ----------
        write : (register or offset, data, strobe), optional
        read_at : str or int
            Register or offset.
        rst : bool
        inputs : int
            Inputs that are not idle.
        """
        assert inputs.keys() <= self.idle.keys(), f"not an input in idle: {inputs}"
        self.inputs = {**self.idle, **inputs}
        # Without a write address and data are random.
        offset, data, strobe = write or (self.random.choice(tuple(self.name_at)), self.random.getrandbits(32), WHOLE)
        offset = self.offset[offset] if isinstance(offset, str) else offset
        mask = strobed_bits(strobe)
        name, ones = self.name_at.get(offset, ""), data & mask
        self.ones, self.write_name = ones, name
        refused = self.refuses(name, ones, mask)
        taken = write is not None and not rst
        allowed = taken and not refused
        read_offset = self.offset[read_at] if isinstance(read_at, str) else read_at
        values = dict(zip(BUS, (taken, offset, ones, mask, read_offset, rst), strict=True)) | self.inputs
        self.drive(**{pin: values[pin] for pin in self.driven})
        self.read_name = self.name_at.get(read_offset, "")
        self.rst, self.allowed = rst, (name, ones, mask) if allowed else None
        await self.edge
        word = self.word(self.read_name)
        self.expect("read_data", word)
        if self.can_refuse:
            self.expect("write_refused", refused)
        for pin, value in self.outputs().items():
            self.expect(pin, value)
        self.step(self.allowed) if not rst else self.reset()
        self.clocks += 1
        return word

    async def random_clocks(
        self, registers: tuple[str, ...], resets: float = 0.005, count: int = RANDOM_CLOCKS
    ) -> None:
        """Write and read registers at random, preferably those named, with `random_inputs`."""
        rng = self.random
        unmapped = tuple(offset for offset in range(0, 1 << ADDRESS_WIDTH, 4) if offset not in self.name_at)

        def any_offset() -> int:
            chosen = rng.random()
            if chosen < 0.8:
                return self.offset[rng.choice(registers)]
            return rng.choice(tuple(self.name_at) if chosen < 0.95 else unmapped)

        for _ in range(count):
            data = rng.choice((rng.getrandbits(32), 1 << rng.randrange(32), rng.getrandbits(4), (1 << 32) - 1))
            strobe = rng.choice((WHOLE, WHOLE, rng.getrandbits(4)))
            write = (any_offset(), data, strobe) if rng.random() < 0.5 else None
            await self.clock(write, any_offset(), rng.random() < resets, **self.random_inputs())

    async def other_offsets(self, registers: tuple[str, ...]) -> None:
        """Write and read at every offset that differs in one bit from that of a register, which was written before."""
        for name in registers * 8:
            for bit in range(32):
                offset = self.offset[name] ^ 1 << bit
                await self.clock((name, WORD, WHOLE), **self.random_inputs())
                await self.clock((offset, self.random.getrandbits(32) | 1, WHOLE), offset, **self.random_inputs())
                await self.clock(read_at=name, **self.random_inputs())

    def random_inputs(self) -> dict[str, Any]:
        """Return random inputs beside the bus."""
        return {}
