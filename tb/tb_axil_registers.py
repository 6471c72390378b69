# SPDX-License-Identifier: Apache-2.0
"""Checks hdl/axil_registers.sv against models/axil_registers.py, every output in every clock."""

from __future__ import annotations

import os
import random
from collections.abc import AsyncIterator, Awaitable
from contextlib import asynccontextmanager

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, RisingEdge, gather
from cocotb_bus.drivers.amba import AXI4LiteMaster, AXIProtocolError

from models.axil_registers import (
    BYTES,
    COUNTERS,
    FRAME_COUNTERS,
    STICKY_EVENTS,
    WORD,
    AxilRegisters,
    Build,
    Events,
    Response,
    signed,
)
from models.register_map import ADDRESS_WIDTH, MAP, REGISTERS

FLAGS = (*STICKY_EVENTS, *FRAME_COUNTERS)
INPUTS = (
    *(f"event_{flag}" for flag in FLAGS),
    *("saturations", "first_depth_latency", "first_depth_latency_valid", "busy", "contact"),
    *(f"s_axil_{pin}" for pin in ("awaddr", "awvalid", "wdata", "wstrb", "wvalid", "bready")),
    *(f"s_axil_{pin}" for pin in ("araddr", "arvalid", "rready")),
)
OFFSET = {register.name: register.offset for register in MAP}
STATUS, CONTROL = REGISTERS["STATUS"], REGISTERS["CONTROL"]
COUNTER_SIGNALS = dict(zip(COUNTERS, ("frames_in", "frames_out", "frames_dropped", "saturations_count"), strict=True))
RANDOM_CLOCKS = 10_000


class Checker:
    """Follows the pins, feeds the model with what it sees there and compares every output in every clock."""

    def __init__(self, dut) -> None:
        self.dut = dut
        names = ("Rows", "Columns", "DataWidth", "GradientWidth", "GradientFraction", "BitsPerChannel")
        self.build = Build(*(int(getattr(dut, name).value) for name in names))
        self.model = AxilRegisters(self.build)
        self.responses: dict[str, list[Response]] = {"read": [], "write": []}
        self.clocks = 0
        self.drop()

    def drop(self) -> None:
        """Forget the transactions in flight."""
        self.address: int | None = None
        self.data: tuple[int, int] | None = None
        self.written: Response | None = None
        self.read: tuple[int, Response] | None = None

    def pin(self, name: str) -> int:
        return int(getattr(self.dut, name).value)

    def bus(self, name: str) -> int:
        return self.pin(f"s_axil_{name}")

    def fires(self, channel: str) -> bool:
        return bool(self.bus(f"{channel}valid") and self.bus(f"{channel}ready"))

    def expect(self, name: str, want: int) -> None:
        got = self.pin(name)
        assert got == want, f"clock {self.clocks}: {name} is {got:#x}, the model says {want:#x}"

    def expect_slope(self, name: str, want: int) -> None:
        self.expect(name, want & (1 << self.build.gradient_width) - 1)

    async def run(self) -> None:
        await RisingEdge(self.dut.clk)  # of the first reset: before it everything is unknown
        while True:
            await RisingEdge(self.dut.clk)
            self.step()
            self.clocks += 1

    def step(self) -> None:
        values, table_writes = self.model.values, len(self.model.table_writes)
        self.expect("s_axil_awready", self.address is None)
        self.expect("s_axil_wready", self.data is None)
        self.expect("s_axil_bvalid", self.written is not None)
        self.expect("s_axil_arready", self.read is None)
        self.expect("s_axil_rvalid", self.read is not None)
        if self.written is not None:
            self.expect("s_axil_bresp", self.written)
        if self.read is not None:
            self.expect("s_axil_rdata", self.read[0])
            self.expect("s_axil_rresp", self.read[1])
        self.expect("threshold", values["THRESHOLD"])
        self.expect("timeout", values["TIMEOUT"])
        self.expect("hold_contact", CONTROL.unpack(values["CONTROL"])["hold_contact"])
        self.expect("table_index", values["TABLE_INDEX"])
        self.expect_slope("table_gx", values["TABLE_GX"])

        busy, contact = bool(self.pin("busy")), bool(self.pin("contact"))
        if self.fires("ar"):
            self.read = self.model.read(self.bus("araddr"), busy, contact)
            self.responses["read"].append(self.read[1])
        elif self.fires("r"):
            self.read = None
        if self.fires("b"):
            self.address = self.data = self.written = None
        elif self.address is not None and self.data is not None and self.written is None and not self.pin("rst"):
            self.written = self.model.write(self.address, *self.data, busy=busy)
            self.responses["write"].append(self.written)
        if self.fires("aw"):
            self.address = self.bus("awaddr")
        if self.fires("w"):
            self.data = self.bus("wdata"), self.bus("wstrb")
        self.expect("table_write", len(self.model.table_writes) - table_writes)
        if len(self.model.table_writes) > table_writes:
            index, gx, gy = self.model.table_writes[-1]
            self.expect("table_index", index)
            self.expect_slope("table_gx", gx)
            self.expect_slope("table_gy", gy)
        self.model.clock(
            Events(
                flags=frozenset(flag for flag in FLAGS if self.pin(f"event_{flag}")),
                saturations=self.pin("saturations"),
                first_depth_latency=(
                    self.pin("first_depth_latency") if self.pin("first_depth_latency_valid") else None
                ),
            )
        )
        if self.pin("rst"):
            self.model.reset()
            self.drop()


async def reset(dut) -> None:
    dut.rst.value = 1
    await ClockCycles(dut.clk, 3)
    dut.rst.value = 0


@asynccontextmanager
async def checked(dut) -> AsyncIterator[Checker]:
    """A clocked, reset device, followed by a Checker until the end of the block."""
    for name in INPUTS:
        getattr(dut, name).value = 0
    dut.rst.value = 1
    Clock(dut.clk, 10, unit="ns").start()
    await RisingEdge(dut.clk)
    checker = Checker(dut)
    follower = cocotb.start_soon(checker.run())
    await reset(dut)
    yield checker
    await ClockCycles(dut.clk, 2)
    assert checker.clocks > 4
    follower.cancel()


async def pulse(dut, **values: int) -> None:
    """Set inputs for one clock."""
    for name, value in values.items():
        getattr(dut, name).value = value
    await RisingEdge(dut.clk)
    for name in values:
        getattr(dut, name).value = 0


async def present(dut, channel: str, **values: int) -> None:
    """Offer one beat on channel aw, w or ar until it is taken; then something else stands there."""
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


async def take(dut, channel: str, stall: int = 0) -> int:
    """Take one response on channel b or r, not before it was there for `stall` clocks; its code."""
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


async def write_beats(dut, address: int, data: int, strobe: int = 0xF) -> None:
    """Address and data of a write, together, without its response."""
    await gather(present(dut, "aw", awaddr=address), present(dut, "w", wdata=data, wstrb=strobe))


async def write(dut, address: int, data: int, strobe: int = 0xF) -> int:
    """Write pin by pin; the response."""
    await write_beats(dut, address, data, strobe)
    return await take(dut, "b")


async def read(dut, address: int) -> tuple[int, int]:
    """Read pin by pin; data and response."""
    await present(dut, "ar", araddr=address)
    while not dut.s_axil_rvalid.value:
        await RisingEdge(dut.clk)
    data = int(dut.s_axil_rdata.value)
    return data, await take(dut, "r")


async def value(dut, name: str) -> int:
    data, response = await read(dut, OFFSET[name])
    assert response == Response.OKAY, f"reading {name} is answered {response}"
    return data


def master_of(dut) -> AXI4LiteMaster:
    """A bus master, which takes every response at once: not to be mixed with the pin-by-pin functions."""
    return AXI4LiteMaster(dut, "s_axil", dut.clk)


async def response_of(transaction: Awaitable) -> Response:
    """How a master's transaction ends; it raises on errors."""
    try:
        await transaction
    except AXIProtocolError as error:
        return Response(error.xresp)
    return Response.OKAY


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def reset_values(dut) -> None:
    """Every register that can be read has its reset value, or that of the build."""
    async with checked(dut) as checker:
        master = master_of(dut)
        for register in MAP:
            if register.access == "wo":
                continue
            data = int(await master.read(register.offset))
            want = checker.model.values[register.name] if register.reset is None else register.reset
            assert data == want, f"{register.name} is {data:#x} after reset, not {want:#x}"
        assert int(await master.read(OFFSET["ID"])).to_bytes(4, "big") == b"TDEP"
        build = checker.build
        grid = REGISTERS["GRID"].unpack(int(await master.read(OFFSET["GRID"])))
        assert grid == {"rows": build.rows, "columns": build.columns}


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def written_words_come_back(dut) -> None:
    """What rw registers hold, whole and byte by byte, through the bus master."""
    async with checked(dut) as checker:
        master = master_of(dut)
        build = checker.build
        index_mask = (1 << 3 * build.bits_per_channel) - 1
        held = {
            "THRESHOLD": lambda word: word,
            "TIMEOUT": lambda word: word,
            "TABLE_INDEX": lambda word: word & index_mask,
            "TABLE_GX": lambda word: signed(word, build.gradient_width) & WORD,
            "CONTROL": lambda word: word & CONTROL.field("hold_contact").mask,
        }
        assert set(held) == {register.name for register in MAP if register.access == "rw"}
        for name, what in held.items():
            for word in (WORD, 0, 0xA5A5_A5A5, 0x5A5A_5A5A, 1 << build.gradient_width - 1):
                await master.write(OFFSET[name], word)
                assert int(await master.read(OFFSET[name])) == what(word), name
        for byte in range(BYTES):
            await master.write(OFFSET["TIMEOUT"], 0x4433_2211)
            await master.write(OFFSET["TIMEOUT"], WORD, byte_enable=1 << byte)
            assert int(await master.read(OFFSET["TIMEOUT"])) == 0x4433_2211 | 0xFF << 8 * byte
        await master.write(OFFSET["THRESHOLD"], -5 & WORD)
        assert dut.threshold.value.to_signed() == -5


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def unaligned_byte_access(dut) -> None:
    """A byte of a register is written and read at its own address, as a processor does."""
    async with checked(dut):
        for byte in range(BYTES):
            address = OFFSET["TIMEOUT"] + byte
            assert await write(dut, address, (0x11 * (byte + 1)) << 8 * byte, 1 << byte) == Response.OKAY
        for byte in range(BYTES):
            assert await read(dut, OFFSET["TIMEOUT"] + byte) == (0x4433_2211, Response.OKAY)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def address_and_data_in_either_order(dut) -> None:
    """Neither is lost, and no answer comes before both were taken."""
    async with checked(dut):
        address = {"channel": "aw", "awaddr": OFFSET["TIMEOUT"]}
        for gap in range(4):
            for address_first in (True, False):
                word = 0x100 * gap + address_first
                data = {"channel": "w", "wdata": word, "wstrb": 0xF}
                first, second = (address, data) if address_first else (data, address)
                await present(dut, **first)
                for _ in range(gap):
                    assert not dut.s_axil_bvalid.value
                    await RisingEdge(dut.clk)
                await present(dut, **second)
                assert await take(dut, "b") == Response.OKAY
                assert await value(dut, "TIMEOUT") == word


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def responses_wait(dut) -> None:
    """A response stays, unchanged, until it is taken, and holds off the next transaction of its kind only."""
    async with checked(dut):
        await write(dut, OFFSET["TIMEOUT"], 7)
        cocotb.start_soon(write_beats(dut, OFFSET["TIMEOUT"], 8))
        while not dut.s_axil_bvalid.value:
            await RisingEdge(dut.clk)
        second = cocotb.start_soon(write_beats(dut, OFFSET["TIMEOUT"], 9))
        assert await value(dut, "TIMEOUT") == 8  # reads go on
        assert await take(dut, "b", stall=10) == Response.OKAY
        await second
        assert await take(dut, "b", stall=3) == Response.OKAY

        await present(dut, "ar", araddr=OFFSET["TIMEOUT"])
        following = cocotb.start_soon(present(dut, "ar", araddr=OFFSET["ID"]))
        assert await write(dut, OFFSET["TIMEOUT"], 10) == Response.OKAY  # writes go on
        assert int(dut.s_axil_rdata.value) == 9  # what it was when its address was taken
        await take(dut, "r", stall=10)
        await following
        await take(dut, "r", stall=3)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def reset_inside_transactions(dut) -> None:
    """A reset at every point of a write and a read leaves nothing behind."""
    async with checked(dut) as checker:
        for clocks in range(6):
            for responses_ready in (0, 1):
                await write(dut, OFFSET["TIMEOUT"], 0x55)
                dut.s_axil_bready.value = dut.s_axil_rready.value = responses_ready
                tasks = [
                    cocotb.start_soon(present(dut, "aw", awaddr=OFFSET["TIMEOUT"])),
                    cocotb.start_soon(present(dut, "ar", araddr=OFFSET["TIMEOUT"])),
                ]
                if clocks % 2:
                    tasks.append(cocotb.start_soon(present(dut, "w", wdata=0x66, wstrb=0xF)))
                await ClockCycles(dut.clk, clocks)
                for task in tasks:
                    task.cancel()
                dut.s_axil_awvalid.value = dut.s_axil_wvalid.value = dut.s_axil_arvalid.value = 0
                dut.s_axil_bready.value = dut.s_axil_rready.value = 0
                await reset(dut)
                await RisingEdge(dut.clk)
                for pin in ("awready", "wready", "arready"):
                    assert checker.bus(pin) == 1, f"{pin} is low after reset"
                assert checker.bus("bvalid") == checker.bus("rvalid") == 0
                assert await value(dut, "TIMEOUT") == 0
                assert await write(dut, OFFSET["TIMEOUT"], 0x77) == Response.OKAY
                assert await value(dut, "TIMEOUT") == 0x77


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def errors_change_nothing(dut) -> None:
    """Unmapped offsets, writes to ro and reads of wo registers: SLVERR, as the map says, and no effect."""
    async with checked(dut) as checker:
        master = master_of(dut)
        for offset in range(0, 1 << ADDRESS_WIDTH, BYTES):
            register = next((r for r in MAP if r.offset == offset), None)
            before = dict(checker.model.values)
            if register is None or register.access == "ro":
                response = await response_of(master.write(offset, WORD))
                assert response == Response.SLVERR, f"a write to {offset:#x} passed"
            readable = register is not None and register.access != "wo"
            response = await response_of(master.read(offset))
            assert response == (Response.OKAY if readable else Response.SLVERR), f"a read of {offset:#x}"
            assert checker.model.values == before
        for register in MAP:
            if register.access != "wo":
                assert int(await master.read(register.offset)) == checker.model.values[register.name]


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def table_writes(dut) -> None:
    """Slope pairs go out in turn, the index runs round, and nothing goes out while busy or half strobed."""
    async with checked(dut) as checker:
        width, size = checker.build.gradient_width, 1 << 3 * checker.build.bits_per_channel
        low, high = -(1 << width - 1), (1 << width - 1) - 1
        pairs = [(low, high), (high, low), (-1, 0), (0, -1), (1, 2)]
        await write(dut, OFFSET["TABLE_INDEX"], size - 2)
        for gx, gy in pairs:
            await write(dut, OFFSET["TABLE_GX"], gx & WORD)
            assert await write(dut, OFFSET["TABLE_GY"], gy & WORD) == Response.OKAY
        want = [((size - 2 + n) % size, *pair) for n, pair in enumerate(pairs)]
        assert checker.model.table_writes == want
        assert await value(dut, "TABLE_INDEX") == 3 % size

        dut.busy.value = 1
        assert await write(dut, OFFSET["TABLE_GY"], 5) == Response.SLVERR
        assert await write(dut, OFFSET["TABLE_GX"], 6) == Response.OKAY  # only TABLE_GY waits
        dut.busy.value = 0
        for strobe in range((1 << BYTES) - 1):
            assert await write(dut, OFFSET["TABLE_GY"], 5, strobe) == Response.SLVERR, f"strobe {strobe:04b}"
        assert checker.model.table_writes == want
        assert await write(dut, OFFSET["TABLE_GY"], 7) == Response.OKAY
        assert checker.model.table_writes[len(want) :] == [(3 % size, 6, 7)]

        # Taken in the clock before a reset, so that it would go out in the reset's first.
        writing = cocotb.start_soon(write(dut, OFFSET["TABLE_GY"], 9))
        while not (checker.fires("aw") and checker.fires("w")):
            await RisingEdge(dut.clk)
        dut.rst.value = 1
        await RisingEdge(dut.clk)
        assert not dut.table_write.value, "written in reset"
        writing.cancel()


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def sticky_bits(dut) -> None:
    """Each event sets its own bit, a written 1 clears that bit alone, the live bits follow their inputs."""
    async with checked(dut):
        sources = {flag: {f"event_{flag}": 1} for flag in STICKY_EVENTS}
        sources["saturation"] = {"saturations": 128}
        for name, inputs in sources.items():
            await pulse(dut, **inputs)
            assert await value(dut, "STATUS") == STATUS.pack(**{name: 1}), name
            await write(dut, STATUS.offset, WORD & ~STATUS.field(name).mask)
            assert await value(dut, "STATUS") == STATUS.pack(**{name: 1}), f"{name} was cleared by a 0"
            await write(dut, STATUS.offset, STATUS.field(name).mask, strobe=0b1110)
            assert await value(dut, "STATUS") == STATUS.pack(**{name: 1}), f"{name} was cleared unstrobed"
            await write(dut, STATUS.offset, STATUS.field(name).mask)
            assert await value(dut, "STATUS") == 0, name
        await pulse(dut, **{f"event_{flag}": 1 for flag in FRAME_COUNTERS})
        assert await value(dut, "STATUS") == 0
        for name in ("busy", "contact"):
            getattr(dut, name).value = 1
            assert await value(dut, "STATUS") == STATUS.pack(**{name: 1})
            await write(dut, STATUS.offset, WORD)
            assert await value(dut, "STATUS") == STATUS.pack(**{name: 1})
            getattr(dut, name).value = 0


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(register=["STATUS", "CONTROL"])
async def setting_wins_over_clearing(dut, register) -> None:
    """Events one clock before, in, and one clock after the clock in which a write clears what they set."""
    async with checked(dut):
        events = {f"event_{flag}": 1 for flag in FLAGS} | {"saturations": 9}
        all_set = STATUS.pack(**dict.fromkeys((*STICKY_EVENTS, "saturation"), 1))
        counted = dict.fromkeys(COUNTERS, 1) | {"SATURATIONS": 9}
        # A write takes effect in the clock after its address and data were taken.
        for lag, survives in ((0, False), (1, True), (2, True)):
            await write(dut, CONTROL.offset, CONTROL.pack(clear_counters=1))
            await pulse(dut, **events)
            beats = cocotb.start_soon(write_beats(dut, OFFSET[register], WORD))
            for _ in range(lag):
                await RisingEdge(dut.clk)
            await pulse(dut, **events)
            await beats
            assert await take(dut, "b") == Response.OKAY
            if register == "STATUS":
                assert await value(dut, "STATUS") == survives * all_set, f"events in clock {lag}"
            else:
                for name, count in counted.items():
                    assert await value(dut, name) == survives * count, f"{name}, events in clock {lag}"


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def counters(dut) -> None:
    """Each counts its own event, stays at all ones, and is cleared."""
    async with checked(dut) as checker:
        sources = {name: {f"event_{flag}": 1} for flag, name in FRAME_COUNTERS.items()}
        sources["SATURATIONS"] = {"saturations": 255}
        for name, inputs in sources.items():
            step = max(inputs.values())
            for _ in range(3):
                await pulse(dut, **inputs)
            assert {other: await value(dut, other) for other in COUNTERS} == dict.fromkeys(COUNTERS, 0) | {
                name: 3 * step
            }
            getattr(dut, COUNTER_SIGNALS[name]).value = WORD - step - 1  # 2^32 events would take too long
            checker.model.values[name] = WORD - step - 1
            for count in (WORD - 1, WORD, WORD):
                await pulse(dut, **inputs)
                assert await value(dut, name) == count, name
            await write(dut, CONTROL.offset, CONTROL.pack(clear_counters=1), strobe=0b1110)
            assert await value(dut, name) == WORD, f"{name} was cleared unstrobed"
            await write(dut, CONTROL.offset, CONTROL.pack(clear_counters=1))
            assert await value(dut, name) == 0, name
            assert await value(dut, "CONTROL") == 0
        await write(dut, STATUS.offset, WORD)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def latency(dut) -> None:
    """The latency last reported stays, through clear_counters too."""
    async with checked(dut):
        for clocks in (0x1234_5678, WORD, 0, 34_567):
            await pulse(dut, first_depth_latency=clocks, first_depth_latency_valid=1)
            await pulse(dut, first_depth_latency=99)
            await write(dut, CONTROL.offset, CONTROL.pack(clear_counters=1))
            assert await value(dut, "FIRST_DEPTH_LATENCY") == clocks


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def each_address_reads_its_own(dut) -> None:
    """Every register with bits of its own, so that another in its place, or two at once, would show at any address."""
    async with checked(dut) as checker:
        rng = random.Random(cocotb.RANDOM_SEED)
        for _ in range(4):
            for name in ("THRESHOLD", "TIMEOUT", "TABLE_INDEX", "TABLE_GX", "CONTROL"):
                await write(dut, OFFSET[name], rng.getrandbits(32) & ~CONTROL.pack(clear_counters=1))
            await pulse(dut, first_depth_latency=rng.getrandbits(32), first_depth_latency_valid=1)
            for name, signal in COUNTER_SIGNALS.items():
                checker.model.values[name] = rng.getrandbits(32)
                getattr(dut, signal).value = checker.model.values[name]
            await pulse(dut, **{f"event_{flag}": rng.getrandbits(1) for flag in STICKY_EVENTS}, saturations=1)
            dut.busy.value, dut.contact.value = rng.getrandbits(1), rng.getrandbits(1)
            for address in range(0, 1 << ADDRESS_WIDTH, 4):
                await read(dut, address)  # compared by the checker
            dut.busy.value, dut.contact.value = 0, 0


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(pressure=[0.0, 0.6])
async def random_traffic(dut, pressure) -> None:
    """Reads, writes and events at random, responses refused with probability `pressure`."""
    rng = random.Random(cocotb.RANDOM_SEED)
    dut._log.info("SEED=%s", os.environ["COCOTB_RANDOM_SEED"])
    async with checked(dut) as checker:
        master = master_of(dut)
        done = False

        def any_offset() -> int:
            unmapped_too = range(0, 1 << ADDRESS_WIDTH, BYTES)
            return rng.choice(tuple(OFFSET.values()) if rng.random() < 0.9 else unmapped_too)

        async def writes() -> None:
            while not done:
                await response_of(
                    master.write(
                        any_offset(),
                        rng.choice((rng.getrandbits(32), 1 << rng.randrange(32), WORD)),
                        byte_enable=rng.choice((None, rng.getrandbits(BYTES))),
                        address_latency=rng.choice((0, 0, 1, 3)),
                        data_latency=rng.choice((0, 0, 1, 3)),
                        sync=rng.random() < 0.5,
                    )
                )

        async def reads() -> None:
            while not done:
                await response_of(master.read(any_offset()))
                for _ in range(rng.choice((0, 0, 1, 5))):
                    await RisingEdge(dut.clk)

        traffic = [cocotb.start_soon(writes()), cocotb.start_soon(reads())]
        for _ in range(RANDOM_CLOCKS):
            for flag in FLAGS:
                getattr(dut, f"event_{flag}").value = rng.random() < 0.05
            dut.saturations.value = rng.getrandbits(8) if rng.random() < 0.05 else 0
            dut.first_depth_latency.value = rng.getrandbits(32)
            dut.first_depth_latency_valid.value = rng.random() < 0.05
            if rng.random() < 0.1:
                dut.busy.value, dut.contact.value = rng.random() < 0.3, rng.random() < 0.5
            dut.s_axil_bready.value = rng.random() >= pressure
            dut.s_axil_rready.value = rng.random() >= pressure
            await RisingEdge(dut.clk)
        done = True
        dut.s_axil_bready.value = dut.s_axil_rready.value = 1
        await gather(*traffic)
        for kind, responses in checker.responses.items():
            seen = {response: responses.count(response) for response in Response}
            dut._log.info("%s: %s, %d table writes", kind, seen, len(checker.model.table_writes))
            assert min(seen.values()) > 10, f"the {kind}s were too much alike: {seen}"
        assert len(checker.model.table_writes) > 5
