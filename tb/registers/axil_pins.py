# SPDX-License-Identifier: Apache-2.0
"""Pins `s_axil_*` as arguments and results of the model of the port, and a checker of every output in every cycle."""

from __future__ import annotations

from collections.abc import Callable, Coroutine
from typing import Any

import cocotb
from cocotb.triggers import ClockCycles, RisingEdge

from tactile_depth.chip.registers.axil_port import AxilPort, Pins
from tb.pins import by_name
from tb.stream import start_clock

INPUTS = tuple(
    f"s_axil_{pin}"
    for pin in ("awaddr", "awvalid", "wdata", "wstrb", "wvalid", "bready", "araddr", "arvalid", "rready")
)


def pins(read: Callable[[str], int]) -> Pins:
    """Return the inputs that the client drives in this cycle, by a function that reads a pin."""
    return Pins(
        read("s_axil_awaddr") if read("s_axil_awvalid") else None,
        (read("s_axil_wdata"), read("s_axil_wstrb")) if read("s_axil_wvalid") else None,
        bool(read("s_axil_bready")),
        read("s_axil_araddr") if read("s_axil_arvalid") else None,
        bool(read("s_axil_rready")),
    )


def expected(port: AxilPort, resets: bool) -> dict[str, int]:
    """Return the outputs of the port in this cycle; data and responses only while they are valid."""
    outputs = {
        "awready": port.address is None and not resets,
        "wready": port.data is None and not resets,
        "bvalid": port.written is not None,
        "arready": port.read_ready and not resets,
        "rvalid": port.answer is not None,
    }
    values = {name: int(high) for name, high in outputs.items()}
    if port.written is not None:
        values["bresp"] = port.written
    if port.answer is not None:
        values["rdata"], values["rresp"] = port.answer
    return {f"s_axil_{name}": value for name, value in values.items()}


async def reset(dut: Any) -> None:
    """Hold the reset for three clocks."""
    dut.rst.value = 1
    await ClockCycles(dut.clk, 3)
    dut.rst.value = 0


class PortChecker:
    """Checker that feeds a model with the input pins in every cycle, and compares every output."""

    inputs: tuple[str, ...] = INPUTS

    def __init__(self, dut: Any) -> None:
        self.dut, self.port, self.clocks = dut, AxilPort(), 0
        self.pin = by_name(dut)

    def expect(self, name: str, value: Any) -> None:
        got = self.pin(name)
        assert got == value, f"clock {self.clocks}: {name} is {got:#x}, expected {value:#x}"

    def begin(self) -> None:
        """Take over what the first reset leaves."""

    def step(self) -> None:
        """Compare the outputs of one cycle."""
        raise NotImplementedError

    def tasks(self) -> list[Coroutine[Any, Any, None]]:
        """Return what runs until the test ends."""
        return [self.run()]

    async def run(self) -> None:
        """Compare until the test ends, from the end of the first reset on: before it all outputs are unknown."""
        edge = RisingEdge(self.dut.clk)
        await edge
        self.begin()
        while True:
            await edge
            self.step()
            self.clocks += 1

    async def start(self) -> None:
        """Clock and reset the core, and begin to compare."""
        for name in self.inputs:
            getattr(self.dut, name).value = 0
        self.dut.rst.value = 1
        start_clock(self.dut.clk)
        await RisingEdge(self.dut.clk)
        for task in self.tasks():
            cocotb.start_soon(task)
        await reset(self.dut)

    async def finish(self) -> None:
        await ClockCycles(self.dut.clk, 3)
        assert self.clocks > 4
