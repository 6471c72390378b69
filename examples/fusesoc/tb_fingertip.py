# SPDX-License-Identifier: Apache-2.0
"""fingertip in simulation: the deepest code of a frame is that of the model of the same configuration."""

from typing import Any

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, ReadOnly, RisingEdge

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.tactile_depth import tactile_depth
from tactile_depth.sensor.scenes import render
from tactile_depth.sensor.synthetic import synthetic

CONFIG = Configuration(columns=16, rows=8, solver="tridiagonal")  # as fingertip.core has it


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def the_deepest_code_of_a_frame(dut: Any) -> None:
    Clock(dut.clk, 10, unit="ns").start()
    dut.rst.value, dut.pixel_valid.value = 1, 0
    await ClockCycles(dut.clk, 3)
    dut.rst.value = 0
    frame = render("ball", CONFIG.rows, CONFIG.columns).frames[0]
    for place, (red, green, blue) in enumerate(frame.reshape(-1, 3).tolist()):
        dut.pixel.value, dut.pixel_valid.value = red << 16 | blue << 8 | green, 1
        dut.frame_start.value = int(place == 0)
        dut.row_end.value = int(place % CONFIG.columns == CONFIG.columns - 1)
        await RisingEdge(dut.clk)
        while not dut.pixel_ready.value:
            await RisingEdge(dut.clk)
    dut.pixel_valid.value = 0
    await RisingEdge(dut.deepest_valid)
    await ReadOnly()
    expected = tactile_depth(frame[None], synthetic(CONFIG.bits_per_channel), CONFIG).max()
    assert dut.deepest.value.to_signed() == expected > 0
