# SPDX-License-Identifier: Apache-2.0
"""setting_registers against its model in every clock."""

from typing import Any

import cocotb

from tactile_depth.chip.registers.register_map import WORD
from tactile_depth.chip.registers.setting_registers import SETTINGS, SettingRegisters
from tb.lockstep import play
from tb.registers.bus import NAME_AT, Bus
from tb.structures import BOTH, ICARUS, Structure

STRUCTURES = (Structure(on=BOTH, mutants=ICARUS),)
PROTOCOL = {"counts": "live"}
NO_PROOF = "every register and output of it is proven through the port: axil_registers"


class Registers(SettingRegisters):
    """The model at the pins of the core."""

    def clock(self, **pins: int) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it."""
        settings = sum(self.values[name] << 32 * n for n, name in enumerate(SETTINGS))
        out = {"read_data": self.values.get(NAME_AT.get(pins["read_offset"], ""), 0), "settings": settings}
        if pins["write"]:
            self.write(NAME_AT.get(pins["write_offset"], ""), pins["write_ones"], pins["write_mask"])
        if pins["rst"]:
            self.reset()
        return out


@cocotb.test
async def registers(dut: Any) -> None:
    resets = int(dut.Resets.value)
    model = Registers({name: resets >> 32 * n & WORD for n, name in enumerate(SETTINGS)})
    bus = Bus(dut, *SETTINGS)
    await play(dut, model, bus.choices, lambda model, pins: bus.drive(pins))
