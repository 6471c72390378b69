# SPDX-License-Identifier: Apache-2.0
"""Pins `s_axil_*` as arguments and results of the model of the port."""

from __future__ import annotations

from typing import Any

from tactile_depth.registers.axil_port import AxilPort, Pins

INPUTS = tuple(
    f"s_axil_{pin}"
    for pin in ("awaddr", "awvalid", "wdata", "wstrb", "wvalid", "bready", "araddr", "arvalid", "rready")
)


def pin(dut: Any, name: str) -> int:
    """Return the value of a pin of the port."""
    return int(getattr(dut, f"s_axil_{name}").value)


def pins(dut: Any) -> Pins:
    """Return the inputs that the client drives in this cycle."""
    return Pins(
        pin(dut, "awaddr") if pin(dut, "awvalid") else None,
        (pin(dut, "wdata"), pin(dut, "wstrb")) if pin(dut, "wvalid") else None,
        bool(pin(dut, "bready")),
        pin(dut, "araddr") if pin(dut, "arvalid") else None,
        bool(pin(dut, "rready")),
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
