# SPDX-License-Identifier: Apache-2.0
"""Requests of a capture, of the testbench of reference_capture."""

from typing import Any

import cocotb
from cocotb.triggers import RisingEdge


async def request(device: Any, log2: int | None = None) -> None:
    """Request a capture of 2**log2 frames; None leaves the exponent as it is."""
    if log2 is not None:
        device.dut.log2_frames.value = log2
    device.dut.request.value = 1
    await RisingEdge(device.dut.clk)
    device.dut.request.value = 0


async def request_after(device: Any, waits: Any, size: int) -> None:
    """Request a capture again, a number of cycles after the first word of a frame, while frames keep coming.

    The device has the attributes dut, chance, busy, inside and captures, and the coroutine send.
    """
    clk = device.dut.clk
    sending = True

    async def frames() -> None:
        while sending:
            await device.send()

    sender = cocotb.start_soon(frames())
    for wait in waits:
        await request(device, 0)
        while device.busy and not device.inside:  # until the first word of a frame, from which `wait` counts
            await RisingEdge(clk)
        for _ in range(wait):
            await RisingEdge(clk)
        await request(device, device.chance.randrange(2))
        for _ in range(device.chance.randrange(2 * size)):
            await RisingEdge(clk)
    while device.busy:
        await RisingEdge(clk)
    sending = False
    await sender
    assert device.captures
