# SPDX-License-Identifier: Apache-2.0
"""Uses of td_ram that its rules allow, and one against each rule."""

from typing import Any

import cocotb
from cocotb.triggers import ClockCycles

from tb.stream import start_clock


async def written(dut: Any, place: int, read: int) -> None:
    """Read and write in one clock, behind those in which a reset comes."""
    start_clock(dut.clk)
    dut.write_en.value = dut.read_en.value = 0
    await ClockCycles(dut.clk, 17)
    dut.write_en.value = dut.read_en.value = 1
    dut.write_address.value, dut.write_data.value, dut.read_address.value = place, 1, read
    await ClockCycles(dut.clk, 2)


@cocotb.test()
async def allowed(dut: Any) -> None:
    await written(dut, 5, 4)


@cocotb.test()
async def read_in_the_clock_that_writes(dut: Any) -> None:
    await written(dut, 4, 4)


@cocotb.test()
async def written_beyond_the_depth(dut: Any) -> None:
    await written(dut, 6, 4)
