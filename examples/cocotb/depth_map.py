# SPDX-License-Identifier: Apache-2.0
"""A small testbench around the pipeline: load a calibration over AXI4-Lite, send a picture, read its depth map.

It needs cocotb, numpy and the package; run.py builds and runs it.
"""

from typing import Any

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, RisingEdge

import tactile_depth as td
from tactile_depth.chip.gradient.gradient_lookup import gradient_codes
from tactile_depth.chip.registers.register_map import REGISTERS, TABLES
from tactile_depth.chip.tactile_depth import Tables, tactile_depth
from tactile_depth.sensor.scenes import render

PIPELINE = td.Pipeline(td.load("synthetic"), grid=(8, 16), boundary="dirichlet", zero_offset=False)  # as `make wrap`


async def write(dut: Any, register: str, value: int) -> None:
    """Write a 32-bit register; address and data are offered together, and no other write before the answer."""
    dut.s_axil_awaddr.value, dut.s_axil_wdata.value = REGISTERS[register].offset, value & 0xFFFF_FFFF
    waiting = {dut.s_axil_awvalid: dut.s_axil_awready, dut.s_axil_wvalid: dut.s_axil_wready}
    for valid in waiting:
        valid.value = 1
    while waiting or not dut.s_axil_bvalid.value:
        await RisingEdge(dut.clk)
        for valid in [valid for valid, ready in waiting.items() if ready.value]:
            valid.value = 0
            del waiting[valid]


async def load(dut: Any, table: np.ndarray) -> None:
    """Write slope codes (bins, 2) into the free bank of the gradient table, and have the next frame use it."""
    await write(dut, "TABLE_SELECT", TABLES["gradient"])
    await write(dut, "TABLE_INDEX", 0)
    for gx, gy in table.tolist():
        await write(dut, "TABLE_HIGH", gy)
        await write(dut, "TABLE_LOW", gx)  # this write stores the entry and moves on to the next one
    await write(dut, "TABLE_COMMIT", REGISTERS["TABLE_COMMIT"].pack(gradient=1))


async def send(dut: Any, picture: np.ndarray) -> None:
    """Send the pixels of a picture (rows, columns, 3), the upper left one first."""
    last = picture.shape[1] - 1
    for place, (red, green, blue) in enumerate(picture.reshape(-1, 3).tolist()):
        dut.s_axis_tdata.value, dut.s_axis_tvalid.value = red << 16 | blue << 8 | green, 1
        dut.s_axis_tuser.value, dut.s_axis_tlast.value = int(place == 0), int(place % (last + 1) == last)
        await RisingEdge(dut.clk)
        while not dut.s_axis_tready.value:
            await RisingEdge(dut.clk)
    dut.s_axis_tvalid.value = 0


async def receive(dut: Any, count: int) -> list[int]:
    """Return depth codes as they leave."""
    codes: list[int] = []
    while len(codes) < count:
        await RisingEdge(dut.clk)
        if dut.m_axis_tvalid.value:
            codes.append(dut.m_axis_tdata.value.to_signed())
    return codes


@cocotb.test(timeout_time=10, timeout_unit="ms")
async def depth_map(dut: Any) -> None:
    """A picture after the new calibration has the depth map that the model computes with it."""
    Clock(dut.clk, 10, unit="ns").start()
    for port in ("s_axis_tvalid", "s_axil_awvalid", "s_axil_wvalid", "s_axil_arvalid", "cold_rst"):
        getattr(dut, port).value = 0
    for port in ("m_axis_tready", "m_event_tready", "s_axil_bready", "s_axil_rready", "rst"):
        getattr(dut, port).value = 1
    dut.s_axil_wstrb.value = 0xF
    await ClockCycles(dut.clk, 4)
    dut.rst.value = 0

    config, sensor = PIPELINE.config, PIPELINE.sensor
    calibration = gradient_codes(sensor, config) // 2  # of a gel that is half as steep at each colour
    await load(dut, calibration)
    picture = render("ball", *PIPELINE.grid).frames[0]
    cocotb.start_soon(send(dut, picture))
    codes = np.reshape(await receive(dut, picture[..., 0].size), PIPELINE.grid)
    expected = tactile_depth(picture[None], sensor, config, tables=Tables(None, calibration))[0]
    np.testing.assert_array_equal(codes, expected)  # the bottom row first, as it leaves
    dut._log.info("depth to %.3f mm", codes.max() * PIPELINE.depth_lsb_mm)
