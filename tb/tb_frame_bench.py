# SPDX-License-Identifier: Apache-2.0
"""What `make sim` runs in the simulator: starts frame_bench, waits for the last frame, reads the registers."""

import json
import os
from pathlib import Path

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, RisingEdge, with_timeout
from cocotb_bus.drivers.amba import AXI4LiteMaster

from models.register_map import REGISTERS

CLOCK_NS = 6


@cocotb.test()
async def stream_frames(dut):
    wanted = json.loads(os.environ["FRAME_BENCH"])
    Clock(dut.clk, CLOCK_NS, unit="ns").start()
    dut.rst.value, dut.go.value = 1, 0
    for name in ("sequence_frames", "total_frames", "seed"):
        getattr(dut, name).value = wanted[name]
    for name in ("gap", "stall"):
        getattr(dut, name).value = min(round(wanted[name] * 2**32), 2**32 - 1)
    dut._log.info("master")
    registers = AXI4LiteMaster(dut, "s_axil", dut.clk)
    await ClockCycles(dut.clk, 4)
    dut.rst.value = 0
    offsets = {register.name: register.offset for register in REGISTERS.values()}
    await registers.write(offsets["THRESHOLD"], wanted["threshold"])
    dut._log.info("go")
    dut.go.value = 1
    # Twice the clocks that gaps and stalls make likely: a pipeline that hangs ends with a failure.
    clocks = int(2 * (wanted["total_frames"] + 4) * wanted["pixels"] / (1 - wanted["gap"]) / (1 - wanted["stall"]))
    await with_timeout(RisingEdge(dut.done), clocks * CLOCK_NS, "ns")
    await ClockCycles(dut.clk, 4)
    counts = {
        name.lower(): int(await registers.read(offsets[name]))
        for name in (
            "STATUS",
            "FRAMES_IN",
            "FRAMES_OUT",
            "FRAMES_DROPPED",
            "SATURATIONS",
            "FIRST_DEPTH_LATENCY",
        )
    }
    Path("registers.json").write_text(json.dumps(counts))
