# SPDX-License-Identifier: Apache-2.0
"""Driver of frame_bench in the simulator: it writes registers, starts the bench, waits for its end and reads
registers."""

import json
from pathlib import Path
from typing import Any

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge, with_timeout
from cocotb_bus.drivers.amba import AXI4LiteMaster

from tactile_depth.chip.registers.register_map import REGISTERS
from tb.settings import RUN

CLOCK_NS = 6
READ = ("STATUS", "FRAMES_IN", "FRAMES_OUT", "FRAMES_DROPPED", "SATURATIONS", "FIRST_DEPTH_LATENCY", "SELF_TEST")


@cocotb.test()
async def play(dut: Any) -> None:
    wanted = RUN.device["frame_bench"]
    clock = Clock(dut.clk, CLOCK_NS, unit="ns", impl="gpi")
    clock.start(start_high=False)
    dut.rst.value, dut.go.value = 1, 0
    for name, value in wanted["inputs"].items():
        getattr(dut, name).value = value
    registers = AXI4LiteMaster(dut, "s_axil", dut.clk)
    await ClockCycles(dut.clk, 4)
    dut.rst.value = 0
    for name, value in wanted["registers"].items():
        await registers.write(REGISTERS[name].offset, value & 0xFFFFFFFF)
    if wanted["clocks_itself"]:
        await FallingEdge(dut.clk)
        clock.stop()
    dut.go.value = 1
    await with_timeout(RisingEdge(dut.done), wanted["clocks"] * CLOCK_NS, "ns")
    if wanted["clocks_itself"]:
        clock.start(start_high=False)
    await ClockCycles(dut.clk, 4)
    counts = {name.lower(): int(await registers.read(REGISTERS[name].offset)) for name in READ}
    Path("registers.json").write_text(json.dumps(counts))
