# SPDX-License-Identifier: Apache-2.0
"""Record of the content of power_up before anything is written to it."""

import json
from pathlib import Path
from typing import Any

import cocotb
from cocotb.triggers import RisingEdge

from tb.stream import start_clock


@cocotb.test()
async def state(dut: Any) -> None:
    start_clock(dut.clk)
    words = []
    for address in range(16):
        dut.address.value = address
        for _ in range(3):
            await RisingEdge(dut.clk)
        words.append(str(dut.word.value))
    Path("seen.json").write_text(json.dumps([str(dut.kept.value), *words]))
