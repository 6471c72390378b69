# SPDX-License-Identifier: Apache-2.0
"""Client of an AXI4-Lite port: single beats, whole transactions, and registers by name."""

from collections.abc import Awaitable
from random import Random
from typing import Any

from cocotb.triggers import RisingEdge, gather
from cocotb_bus.drivers.amba import AXI4LiteMaster, AXIProtocolError

from tactile_depth.chip.registers.axil_port import Response, strobed_bits
from tactile_depth.chip.registers.register_map import MAP, WORD

CLIENT = {  # PROTOCOL of a core with the port
    "stays": "s_axil_aw s_axil_w s_axil_ar",
    "s_axil_bresp": "live & s_axil_bvalid",
    "s_axil_rdata s_axil_rresp": "live & s_axil_rvalid",
}
OFFSET = {register.name: register.offset for register in MAP}


async def present(dut: Any, channel: str, **values: Any) -> None:
    """Offer one beat on channel aw, w or ar until it is taken; afterwards the pins hold other data."""
    for name, value in values.items():
        getattr(dut, f"s_axil_{name}").value = value
    valid, ready = (getattr(dut, f"s_axil_{channel}{wire}") for wire in ("valid", "ready"))
    valid.value = 1
    await RisingEdge(dut.clk)
    while not ready.value:
        await RisingEdge(dut.clk)
    valid.value = 0
    for name, value in values.items():
        pin = getattr(dut, f"s_axil_{name}")
        pin.value = value ^ ((1 << len(pin)) - 1)


async def take(dut: Any, channel: str, stall: int = 0) -> int:
    """Take one response on channel b or r after it has been valid for `stall` cycles; return its code."""
    valid, ready = (getattr(dut, f"s_axil_{channel}{wire}") for wire in ("valid", "ready"))
    while not valid.value:
        await RisingEdge(dut.clk)
    for _ in range(stall):
        await RisingEdge(dut.clk)
        assert valid.value, f"{channel}valid fell before {channel}ready came"
    ready.value = 1
    await RisingEdge(dut.clk)
    response = int(getattr(dut, f"s_axil_{channel}resp").value)
    ready.value = 0
    await RisingEdge(dut.clk)
    return response


async def write(dut: Any, address: int, data: int, strobe: int = 0xF) -> int:
    """Write beat by beat; return the response."""
    await gather(present(dut, "aw", awaddr=address), present(dut, "w", wdata=data, wstrb=strobe))
    return await take(dut, "b")


async def read(dut: Any, address: int) -> tuple[int, int]:
    """Read beat by beat; return data and response."""
    await present(dut, "ar", araddr=address)
    while not dut.s_axil_rvalid.value:
        await RisingEdge(dut.clk)
    data = int(dut.s_axil_rdata.value)
    return data, await take(dut, "r")


async def value_of(dut: Any, name: str) -> int:
    data, response = await read(dut, OFFSET[name])
    assert response == Response.OKAY, f"reading {name} is answered {response}"
    return data


async def response_of(transaction: Awaitable) -> Response:
    """Return the response that ends a transaction of a master, also when the master raises it as an error."""
    try:
        await transaction
    except AXIProtocolError as error:
        return Response(error.xresp)
    return Response.OKAY


async def check_waits(dut: Any, random: Random) -> None:
    """Write the register TIMEOUT with address and word in either order: each is taken once, and responses stay until
    they are taken; bytes without a strobe keep their value."""
    pins = {name: getattr(dut, f"s_axil_{name}") for name in ("awready", "wready", "arready", "bvalid", "rvalid")}
    dut.s_axil_bready.value = dut.s_axil_rready.value = 0

    async def stays(clocks: int = 3, **wanted: Any) -> None:
        for _ in range(clocks):
            await RisingEdge(dut.clk)
            got = {name: int(pin.value) for name, pin in pins.items()}
            assert got == {"awready": 1, "wready": 1, "arready": 1, "bvalid": 0, "rvalid": 0} | wanted

    held = 0
    for strobe in (15, *range(16), 15):
        data = random.getrandbits(32)
        beats = {"aw": {"awaddr": OFFSET["TIMEOUT"]}, "w": {"wdata": data, "wstrb": strobe}}
        first, second = beats if strobe & 1 else reversed(beats)
        await stays()
        await present(dut, first, **beats[first])
        await RisingEdge(dut.clk)
        await stays(**{f"{first}ready": 0})
        await present(dut, second, **beats[second])
        while not dut.s_axil_bvalid.value:
            await RisingEdge(dut.clk)
        await stays(awready=0, wready=0, bvalid=1)
        assert await take(dut, "b", 2) == Response.OKAY
        mask = strobed_bits(strobe)
        held = data & mask | held & ~mask
        await present(dut, "ar", araddr=OFFSET["TIMEOUT"])
        await RisingEdge(dut.clk)
        for _ in range(4):
            await stays(1, arready=0, rvalid=1)
            assert int(dut.s_axil_rdata.value) == held
        assert await take(dut, "r", 2) == Response.OKAY
    assert await write(dut, OFFSET["GRID"], 0) == Response.SLVERR
    assert await write(dut, OFFSET["TIMEOUT"], 0) == Response.OKAY
    assert await read(dut, OFFSET["TIMEOUT"]) == (0, Response.OKAY)


class Master:
    """Bus master that takes every response at once. Do not mix it with the beat-by-beat functions."""

    def __init__(self, dut: Any) -> None:
        self.master = AXI4LiteMaster(dut, "s_axil", dut.clk)

    async def write(self, address: int, value: int) -> Response:
        return await response_of(self.master.write(address, value))

    async def read(self, address: int) -> int:
        return int(await self.master.read(address))


class RegisterClient:
    """Writes and reads registers by their names, through any master with `write` and `read`."""

    def __init__(self, master: Any) -> None:
        self.master = master

    async def write(self, name: str, value: int) -> Response:
        """Write a register and return the response. Of a negative value the lower 32 bits are written."""
        return Response(await self.master.write(OFFSET[name], value & WORD))

    async def read(self, name: str) -> int:
        return int(await self.master.read(OFFSET[name]))
