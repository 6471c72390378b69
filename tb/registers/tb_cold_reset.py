# SPDX-License-Identifier: Apache-2.0
"""Netlist of tactile_depth with unknown registers at power-up: state after a cold reset, at the pins."""

from __future__ import annotations

from typing import Any

import cocotb
from cocotb.triggers import ClockCycles, RisingEdge

from tactile_depth.chip.registers.register_map import REGISTERS
from tb.axil import OFFSET, present, value_of, write
from tb.stream import start_clock

INPUTS = (
    *("s_axis_tdata", "s_axis_tvalid", "s_axis_tlast", "s_axis_tuser", "m_axis_tready", "m_event_tready"),
    *(f"s_axil_{pin}" for pin in ("awaddr", "awprot", "awvalid", "wdata", "wstrb", "wvalid", "bready")),
    *(f"s_axil_{pin}" for pin in ("araddr", "arprot", "arvalid", "rready")),
)
HANDSHAKES = (
    *("s_axis_tready", "m_axis_tvalid", "m_event_tvalid", "contact", "irq"),
    *(f"s_axil_{pin}" for pin in ("awready", "wready", "bvalid", "arready", "rvalid")),
)
COMMIT = "TABLE_COMMIT"


async def reset(dut: Any, cold: int) -> None:
    """Hold the reset for four clocks."""
    dut.rst.value, dut.cold_rst.value = 1, cold
    await ClockCycles(dut.clk, 4)
    dut.rst.value, dut.cold_rst.value = 0, 0
    await RisingEdge(dut.clk)


async def pending(dut: Any) -> str:
    """Return the bits of TABLE_COMMIT, X where they are unknown."""
    dut.s_axil_rready.value = 0
    await present(dut, "ar", araddr=OFFSET[COMMIT])
    while str(dut.s_axil_rvalid.value) != "1":
        await RisingEdge(dut.clk)
    word = str(dut.s_axil_rdata.value)[-REGISTERS[COMMIT].fields[-1].high - 1 :]
    dut.s_axil_rready.value = 1
    await ClockCycles(dut.clk, 2)
    dut.s_axil_rready.value = 0
    return word


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def banks_are_known_after_a_cold_reset(dut: Any) -> None:
    """Reset: alone it leaves the banks unknown; with cold_rst every table uses its first bank, which later resets
    keep."""
    for name in INPUTS:
        getattr(dut, name).value = 0
    start_clock(dut.clk)
    await reset(dut, cold=0)
    assert "X" in (await pending(dut)).upper(), "the test is void: the banks had a value at power-up"
    await reset(dut, cold=1)
    for name in HANDSHAKES:
        assert getattr(dut, name).value.is_resolvable, f"{name} is unknown"
    assert await pending(dut) == "0000"
    tables = REGISTERS[COMMIT].mask()
    assert await write(dut, OFFSET[COMMIT], tables) == 0
    requested = await value_of(dut, COMMIT)
    assert requested
    await reset(dut, cold=0)
    assert await pending(dut) == "0000"
