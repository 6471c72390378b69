# SPDX-License-Identifier: Apache-2.0
"""The smallest testbench around the pipeline: load a calibration over AXI4-Lite, send a frame, read its depth map.

Run it with `.venv/bin/python examples/cocotb/run.py verilator` or `.. icarus`.
"""

import json
import os
from typing import Any

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles
from cocotbext.axi import AxiLiteBus, AxiLiteMaster, AxiStreamBus, AxiStreamFrame, AxiStreamSink, AxiStreamSource

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.gradient_lookup import gradient_codes
from tactile_depth.chip.registers.register_map import REGISTERS, TABLES
from tactile_depth.chip.tactile_depth import Tables, tactile_depth
from tactile_depth.sensor.scenes import render
from tactile_depth.sensor.synthetic import synthetic


async def write(master: AxiLiteMaster, register: str, value: int) -> None:
    """Write a 32-bit register."""
    await master.write_dword(REGISTERS[register].offset, value & 0xFFFF_FFFF)


async def load(master: AxiLiteMaster, table: np.ndarray) -> None:
    """Write slope codes (bins, 2) into the free bank of the gradient table, and have the next frame use it."""
    await write(master, "TABLE_SELECT", TABLES["gradient"])
    await write(master, "TABLE_INDEX", 0)
    for gx, gy in table.tolist():
        await write(master, "TABLE_HIGH", gy)
        await write(master, "TABLE_LOW", gx)  # this write stores the entry and moves on to the next one
    await write(master, "TABLE_COMMIT", REGISTERS["TABLE_COMMIT"].pack(gradient=1))


@cocotb.test()
async def depth_map(dut: Any) -> None:
    """A frame after the new calibration has the depth map that the model computes with it."""
    config = Configuration(**json.loads(os.environ["CONFIGURATION"]))
    sensor = synthetic(config.bits_per_channel)
    Clock(dut.clk, 10, unit="ns").start()
    source = AxiStreamSource(AxiStreamBus.from_prefix(dut, "s_axis"), dut.clk, dut.rst, byte_lanes=1)
    sink = AxiStreamSink(AxiStreamBus.from_prefix(dut, "m_axis"), dut.clk, dut.rst, byte_lanes=1)
    master = AxiLiteMaster(AxiLiteBus.from_prefix(dut, "s_axil"), dut.clk, dut.rst)
    dut.m_event_tready.value = 1
    dut.rst.value, dut.cold_rst.value = 1, 0
    await ClockCycles(dut.clk, 4)
    dut.rst.value = 0

    calibration = gradient_codes(sensor, config) // 2  # of a gel that is half as steep at each colour
    await load(master, calibration)

    frame = render("ball", config.rows, config.columns).frames[0]
    for row, pixels in enumerate(frame.astype(int)):
        words = [red << 16 | blue << 8 | green for red, green, blue in pixels.tolist()]
        user = [int(row == 0 and column == 0) for column in range(config.columns)]  # the start of the frame
        await source.send(AxiStreamFrame(tdata=words, tuser=user))

    rows = [await sink.recv(compact=False) for _ in range(config.rows)]
    bits = 8 * ((config.data_width + 7) // 8)
    codes = np.array([[(word ^ 1 << bits - 1) - (1 << bits - 1) for word in row.tdata] for row in rows])
    expected = tactile_depth(frame[None], sensor, config, tables=Tables(None, calibration))[0]
    np.testing.assert_array_equal(codes, expected)

    depth_mm = codes[::-1] * config.depth_lsb_px * sensor.pixel_pitch_mm  # the bottom row came first
    dut._log.info("depth from %.3f to %.3f mm", depth_mm.min(), depth_mm.max())
