# SPDX-License-Identifier: Apache-2.0
"""setting_registers against tactile_depth.chip.registers.setting_registers, every output in every cycle."""

from __future__ import annotations

from typing import Any

from tactile_depth.chip.registers.register_map import REGISTERS, WORD
from tactile_depth.chip.registers.setting_registers import MASKS, RESETS, SETTINGS, SettingRegisters
from tb.cases import on_bench
from tb.registers.register_bench import WHOLE, RegisterBench
from tb.stream import parametrize
from tb.structures import BOTH, ICARUS, Structure

STRUCTURES = (Structure(on=BOTH, mutants=ICARUS),)
PROTOCOL = {"counts": "live"}
NO_PROOF = "every register and output of it is proven through the port: axil_registers"


class Bench(RegisterBench):
    """Bench of setting_registers."""

    def __init__(self, dut: Any) -> None:
        super().__init__(dut)
        reset_values = int(dut.Resets.value)
        self.model = SettingRegisters({name: reset_values >> 32 * n & WORD for n, name in enumerate(SETTINGS)})

    def word(self, name: str) -> int:
        return self.model.values.get(name, 0)

    def outputs(self) -> dict[str, int]:
        return {"settings": sum(self.model.values[name] << 32 * n for n, name in enumerate(SETTINGS))}

    def step(self, write: tuple[str, int, int] | None) -> None:
        if write:
            self.model.write(*write)

    def reset(self) -> None:
        self.model.reset()


@on_bench(Bench)
async def reset_values(bench: Bench) -> None:
    """Reset: every setting has the value of the map."""
    for name in SETTINGS:
        fields = [f for f in REGISTERS[name].fields if f.setting and f.reset is not None]
        assert RESETS[name] == sum((f.reset or 0) << f.low for f in fields)
        assert await bench.clock(read_at=name) == bench.model.resets[name]


@on_bench(Bench)
@parametrize(name=list(SETTINGS))
async def every_bit_and_byte(bench: Bench, name: str) -> None:
    """Write single bits and bytes: a write sets the bits of its strobed bytes, and no other bit."""
    for strobe in range(16):
        for word in (0, WORD, 0x5AA5_C33C):
            await bench.clock(write=(name, ~word & WORD, WHOLE), read_at=name)
            await bench.clock(write=(name, word, strobe), read_at=name)
            await bench.clock(read_at=name)
    for bit in range(32):
        await bench.clock(write=(name, 1 << bit, WHOLE), read_at=name)
        assert await bench.clock(read_at=name) == 1 << bit & MASKS[name]


@on_bench(Bench)
async def random_writes(bench: Bench) -> None:
    """Drive random writes, reads and resets."""
    await bench.random_clocks(tuple(SETTINGS))


@on_bench(Bench)
async def other_offsets(bench: Bench) -> None:
    """Access offsets that differ in one bit from that of a register: they are not taken for it."""
    await bench.other_offsets(tuple(SETTINGS))
