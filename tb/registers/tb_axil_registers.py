# SPDX-License-Identifier: Apache-2.0
"""Checks hdl/registers/axil_registers.sv against its model, every output in every clock."""

from __future__ import annotations

import os
import random
from collections.abc import AsyncIterator, Awaitable
from contextlib import asynccontextmanager
from typing import Any

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, RisingEdge, gather
from cocotb_bus.drivers.amba import AXI4LiteMaster, AXIProtocolError

from tactile_depth.registers.axil_registers import (
    BYTES,
    CAPTURES,
    COUNTERS,
    EVENT_COUNTERS,
    RECORD,
    STICKY_EVENTS,
    WORD,
    AxilRegisters,
    Build,
    Events,
    Live,
    Response,
    strobed_bits,
)
from tactile_depth.registers.register_map import ADDRESS_WIDTH, MAP, REGISTERS, TABLES
from tb.stream import REGRESS

FLAGS = tuple(dict.fromkeys((*STICKY_EVENTS, *EVENT_COUNTERS)))  # some are both
LEVELS = ("busy", "contact", "touching")  # live bits of STATUS, and inputs
INPUTS = (
    *(f"event_{flag}" for flag in FLAGS),
    *("saturations", "first_depth_latency", "first_depth_latency_valid", *LEVELS, "record", "frame_start"),
    *("capture_busy", "capture_done", "floor_busy", "floor_done"),
    *("table_read_high", "table_read_low", "table_in_use"),
    *(f"s_axil_{pin}" for pin in ("awaddr", "awvalid", "wdata", "wstrb", "wvalid", "bready")),
    *(f"s_axil_{pin}" for pin in ("araddr", "arvalid", "rready")),
)
OFFSET = {register.name: register.offset for register in MAP}
STATUS, CONTROL = REGISTERS["STATUS"], REGISTERS["CONTROL"]
PINS = {"reference": "capture", "floor": "floor"}  # of what measures a table
COUNTER_SIGNALS = {name: name.lower() for name in COUNTERS} | {"SATURATIONS": "saturations_count"}
HELD = ("THRESHOLD", "OFF_THRESHOLD", "MINIMUM_AREA", "DEBOUNCE", "TIMEOUT", "DARK_LEVEL")  # as outputs
RANDOM_CLOCKS = 10_000 if REGRESS else 2_000
TABLE_CLOCKS = 4  # from the one in which an entry is asked for to that which takes its words, both counted


def entry(table: int, index: int) -> tuple[int, int]:
    """Words (high, low) of an entry of the tables behind the registers: other ones for each."""
    low = (index + 1) * 0x9E37_79B1 + (table + 1) * 0x85EB_CA6B & WORD
    return low * 0xC2B2_AE35 >> 5 & WORD, low


class Checker:
    """Follows the pins, feeds the model with what it sees there and compares every output in every clock."""

    def __init__(self, dut: Any) -> None:
        self.dut = dut
        names = ["Rows", "Columns", "DataWidth", "GradientWidth", "GradientFraction", "BitsPerChannel"]
        names += ["CoefficientWords", "ReferenceWords", "FloorWords"]
        self.build = Build(*(int(getattr(dut, name).value) for name in names))
        self.model = AxilRegisters(self.build, entry)
        self.responses: dict[str, list[Response]] = {"read": [], "write": []}
        self.clocks = 0
        self.drop()

    def drop(self) -> None:
        """Forget the transactions in flight."""
        self.address: Any = None
        self.data: tuple[int, int] | None = None
        self.written: Response | None = None
        self.read: Any = None
        self.asked: int | None = None  # a table, by a read of this address
        self.asked_for = 0  # clocks

    def pin(self, name: str) -> int:
        return int(getattr(self.dut, name).value)

    def bus(self, name: str) -> int:
        return self.pin(f"s_axil_{name}")

    def fires(self, channel: str) -> bool:
        return bool(self.bus(f"{channel}valid") and self.bus(f"{channel}ready"))

    def expect(self, name: str, want: Any) -> None:
        got = self.pin(name)
        assert got == want, f"clock {self.clocks}: {name} is {got:#x}, the model says {want:#x}"

    async def run(self) -> None:
        await RisingEdge(self.dut.clk)  # of the first reset: before it everything is unknown
        self.model.bank = self.pin("table_bank")  # of the test before: no reset touches it
        while True:
            await RisingEdge(self.dut.clk)
            self.step()
            self.clocks += 1

    def step(self) -> None:
        model, values = self.model, self.model.values
        resets = bool(self.pin("rst"))
        self.expect("s_axil_awready", self.address is None)
        self.expect("s_axil_wready", self.data is None)
        self.expect("s_axil_bvalid", self.written is not None)
        self.expect("s_axil_arready", self.read is None and self.asked is None)
        self.expect("s_axil_rvalid", self.read is not None and self.asked is None)
        if self.written is not None:
            self.expect("s_axil_bresp", self.written)
        if self.read is not None and self.asked is None:
            self.expect("s_axil_rdata", self.read[0])
            self.expect("s_axil_rresp", self.read[1])
        for name in HELD:
            self.expect(name.lower(), values[name])
        for name in ("hold_contact", "drop_frames"):
            self.expect(name, CONTROL.unpack(values["CONTROL"])[name])
        for table, register in CAPTURES.items():
            self.expect(f"{PINS[table]}_log2_frames", register.unpack(values[register.name])["log2_frames"])
        self.expect("table_select", model.table)
        self.expect("table_index", values["TABLE_INDEX"])
        self.expect("table_high", values["TABLE_HIGH"])
        starts = bool(self.pin("frame_start"))
        self.expect("table_bank", model.bank_wanted(starts and not resets))

        record = self.pin("record")
        captured = frozenset(table for table, pin in PINS.items() if self.pin(f"{pin}_done"))
        live = Live(
            **{name: bool(self.pin(name)) for name in LEVELS},
            capturing=frozenset(table for table, pin in PINS.items() if self.pin(f"{pin}_busy")),
            ending=captured,
            in_use=self.pin("table_in_use"),
            record=tuple(record >> 32 * word & WORD for word in range(len(RECORD))),
        )
        asked_before = self.asked
        table_read = False
        if self.asked is not None:
            self.asked_for += 1
            if self.asked_for == 1:  # the others wait for what it brings
                self.read = model.read(self.asked)
                table_read = self.read[1] == Response.OKAY
            elif self.asked_for == TABLE_CLOCKS:
                self.asked = None
                self.responses["read"].append(self.read[1])
        elif self.fires("ar"):
            if model.is_port(self.bus("araddr")):
                self.asked, self.asked_for = self.bus("araddr"), 0
            else:
                self.read = model.read(self.bus("araddr"), live)
                self.responses["read"].append(self.read[1])
        elif self.fires("r"):
            self.read = None
        self.expect("table_read", table_read and not resets)
        writes, captures = len(model.table_writes), len(model.captures)
        if self.fires("b"):
            self.address = self.data = self.written = None
        elif (
            None not in (self.address, self.data)
            and self.written is None
            and asked_before is None
            and not self.pin("rst")
        ):
            self.written = model.write(self.address, *self.data, live)  # type: ignore[call-arg, misc]
            self.responses["write"].append(self.written)
        if self.fires("aw"):
            self.address = self.bus("awaddr")
        if self.fires("w"):
            self.data = self.bus("wdata"), self.bus("wstrb")
        for table, pin in PINS.items():
            self.expect(f"{pin}_request", model.captures[captures:] == [table])
        self.expect("table_write", len(model.table_writes) - writes)
        if len(model.table_writes) > writes:
            table, index, high, low = model.table_writes[-1]  # type: ignore[assignment]
            self.expect("table_select", table)
            self.expect("table_index", index)
            self.expect("table_high", high)
            self.expect("table_low", low)
        model.clock(
            Events(
                flags=frozenset(flag for flag in FLAGS if self.pin(f"event_{flag}")),
                saturations=self.pin("saturations"),
                first_depth_latency=(
                    self.pin("first_depth_latency") if self.pin("first_depth_latency_valid") else None
                ),
                frame_start=starts and not resets,
                captured=captured,
            )
        )
        if resets:
            model.reset()
            self.drop()


class Tables:
    """Tables behind the table ports. The words of an entry come as late as allowed, after other words.

    A table changes its bank `lag` clocks after the frame start.
    """

    def __init__(self, dut: Any, lag: int = 0) -> None:
        self.dut, self.lag = dut, lag
        self.random = random.Random(lag)

    async def run(self) -> None:
        dut, late, due = self.dut, 0, []
        while True:
            await RisingEdge(dut.clk)
            if dut.table_read.value:
                due = [*[None] * (TABLE_CLOCKS - 2), entry(int(dut.table_select.value), int(dut.table_index.value))]
                dut.table_read_high.value, dut.table_read_low.value = (self.random.getrandbits(32) for _ in range(2))
            if due and (words := due.pop(0)) is not None:
                dut.table_read_high.value, dut.table_read_low.value = words
            wanted, used = dut.table_bank.value, dut.table_in_use.value
            late = late + 1 if wanted != used else 0
            if dut.rst.value or late > self.lag:
                dut.table_in_use.value = int(wanted)
                late = 0


async def reset(dut: Any) -> None:
    dut.rst.value = 1
    await ClockCycles(dut.clk, 3)
    dut.rst.value = 0


@asynccontextmanager
async def checked(dut: Any, lag: int = 0) -> AsyncIterator[Checker]:
    """A clocked, reset device, followed by a Checker until the end of the block; `lag`: of its tables."""
    for name in INPUTS:
        getattr(dut, name).value = 0
    dut.rst.value = 1
    Clock(dut.clk, 10, unit="ns", impl="gpi").start(start_high=False)
    await RisingEdge(dut.clk)
    checker = Checker(dut)
    follower = cocotb.start_soon(checker.run())
    tables = cocotb.start_soon(Tables(dut, lag).run())
    await reset(dut)
    yield checker
    await ClockCycles(dut.clk, 2)
    assert checker.clocks > 4
    follower.cancel()
    tables.cancel()


async def pulse(dut: Any, **values: int) -> None:
    """Set inputs for one clock."""
    for name, value in values.items():
        getattr(dut, name).value = value
    await RisingEdge(dut.clk)
    for name in values:
        getattr(dut, name).value = 0


async def present(dut: Any, channel: str, **values: Any) -> None:
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


async def take(dut: Any, channel: str, stall: int = 0) -> int:
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


async def write_beats(dut: Any, address: int, data: int, strobe: int = 0xF) -> None:
    """Address and data of a write, together, without its response."""
    await gather(present(dut, "aw", awaddr=address), present(dut, "w", wdata=data, wstrb=strobe))


async def write(dut: Any, address: int, data: int, strobe: int = 0xF) -> int:
    """Write pin by pin; the response."""
    await write_beats(dut, address, data, strobe)
    return await take(dut, "b")


async def read(dut: Any, address: int) -> tuple[int, int]:
    """Read pin by pin; data and response."""
    await present(dut, "ar", araddr=address)
    while not dut.s_axil_rvalid.value:
        await RisingEdge(dut.clk)
    data = int(dut.s_axil_rdata.value)
    return data, await take(dut, "r")


async def value(dut: Any, name: str) -> int:
    data, response = await read(dut, OFFSET[name])
    assert response == Response.OKAY, f"reading {name} is answered {response}"
    return data


def master_of(dut: Any) -> AXI4LiteMaster:
    """A bus master, which takes every response at once: not to be mixed with the pin-by-pin functions."""
    return AXI4LiteMaster(dut, "s_axil", dut.clk)


async def response_of(transaction: Awaitable) -> Response:
    """Return the response that ends a master's transaction; errors raise."""
    try:
        await transaction
    except AXIProtocolError as error:
        return Response(error.xresp)
    return Response.OKAY


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def reset_values(dut: Any) -> None:
    """Every field has the reset value of the map, or that of the build; bits of no field read 0."""
    async with checked(dut) as checker:
        for register in MAP:
            data = (await read(dut, register.offset))[0]
            assert data & ~register.mask() == 0, f"{register.name} has bits that are not listed"
            for field in register.fields:
                if field.reset is not None:
                    got = register.unpack(data)[field.name]
                    assert got == field.reset, f"{register.name}.{field.name} is {got:#x} after reset"
        assert (await value(dut, "ID")).to_bytes(4, "big") == b"TDEP"
        build = checker.build
        assert REGISTERS["GRID"].unpack(await value(dut, "GRID")) == {"rows": build.rows, "columns": build.columns}
        form = REGISTERS["FORMAT"].unpack(await value(dut, "FORMAT"))
        assert form == {name: getattr(build, name) for name in form}


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(register=[r.name for r in MAP if "port" not in {f.access for f in r.fields}])
async def access(dut: Any, register: Any) -> None:
    """Every bit does what the access of its field says, bit by bit and byte by byte; what lies behind the others is
    tested with the tables."""
    async with checked(dut) as checker:
        register, build = REGISTERS[register], checker.build
        everything = STATUS.mask("w1c")
        refused = {  # by name: bits of a word that is refused
            capture.name: capture.field("start").mask
            for table, capture in CAPTURES.items()
            if not build.table_sizes[TABLES[table]]
        }
        held = register.mask("rw")
        if register.name == "TABLE_INDEX":
            held = (1 << build.index_width) - 1
        await pulse(dut, saturations=1, **{f"event_{flag}": 1 for flag in FLAGS})
        before = await value(dut, register.name)
        if not register.writable:
            for word in (0, WORD):
                assert await write(dut, register.offset, word) == Response.SLVERR
            assert await value(dut, register.name) == before
            return
        rng = random.Random(cocotb.RANDOM_SEED)
        single_bits = [(1 << bit, 0xF) for bit in range(32)]
        words = [(WORD, 0), (WORD, 0xF), (0, 0xF), (WORD, 0xF), *single_bits]
        for word, strobe in [*words, *((rng.getrandbits(32), strobe) for strobe in range(1 << BYTES))]:
            old = await value(dut, register.name)
            strobed = strobed_bits(strobe)
            if word & strobed & refused.get(register.name, 0):
                assert await write(dut, register.offset, word, strobe) == Response.SLVERR
                assert await value(dut, register.name) == old
                continue
            assert await write(dut, register.offset, word, strobe) == Response.OKAY
            want = {
                "ro": old & register.mask("ro"),
                "rw": (word & strobed | old & ~strobed) & held,
                "w1c": old & ~(word & strobed) & register.mask("w1c"),
                "w1s": (old | word & strobed & tables_present(build)) & register.mask("w1s"),
                "pulse": 0,
            }
            got = await value(dut, register.name)
            assert got == sum(want.values()), f"{register.name} is {got:#x} after {word:#x} strobed {strobe:04b}"
            if register is STATUS:
                await pulse(dut, saturations=1, **{f"event_{flag}": 1 for flag in FLAGS})
                assert await value(dut, "STATUS") == everything


def tables_present(build: Build) -> int:
    """Bits of TABLE_COMMIT of the tables that the build has."""
    return sum(1 << table for table, size in build.table_sizes.items() if size)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def outputs(dut: Any) -> None:
    """A second bus master writes registers; the outputs to the pipeline and the words read back are right."""
    async with checked(dut):
        master = master_of(dut)
        for name in ("THRESHOLD", "OFF_THRESHOLD"):
            await master.write(OFFSET[name], -5 & WORD)
            assert getattr(dut, name.lower()).value.to_signed() == -5
        await master.write(OFFSET["TIMEOUT"], 0x4433_2211)
        assert int(await master.read(OFFSET["TIMEOUT"])) == int(dut.timeout.value) == 0x4433_2211


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def unaligned_byte_access(dut: Any) -> None:
    """A byte of a register is written and read at its own address, as a processor does."""
    async with checked(dut):
        for byte in range(BYTES):
            address = OFFSET["TIMEOUT"] + byte
            assert await write(dut, address, (0x11 * (byte + 1)) << 8 * byte, 1 << byte) == Response.OKAY
        for byte in range(BYTES):
            assert await read(dut, OFFSET["TIMEOUT"] + byte) == (0x4433_2211, Response.OKAY)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def address_and_data_in_either_order(dut: Any) -> None:
    """Neither is lost, and no answer comes before both were taken."""
    async with checked(dut):
        address = {"channel": "aw", "awaddr": OFFSET["TIMEOUT"]}
        for gap in range(4):
            for address_first in (True, False):
                word = 0x100 * gap + address_first
                data: dict[str, Any] = {"channel": "w", "wdata": word, "wstrb": 0xF}
                first, second = (address, data) if address_first else (data, address)
                await present(dut, **first)
                for _ in range(gap):
                    assert not dut.s_axil_bvalid.value
                    await RisingEdge(dut.clk)
                await present(dut, **second)
                assert await take(dut, "b") == Response.OKAY
                assert await value(dut, "TIMEOUT") == word


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(ahead=["aw", "w"])
async def the_next_waits_for_this(dut: Any, ahead: Any) -> None:
    """An address, or a word, that is offered while the one before it waits for its other half stays out."""
    async with checked(dut):
        writes = [("TIMEOUT", 0x1234), ("MINIMUM_AREA", 0xABCDEF01)]
        addresses: list[dict[str, Any]] = [{"channel": "aw", "awaddr": OFFSET[name]} for name, _ in writes]
        words: list[dict[str, Any]] = [{"channel": "w", "wdata": word, "wstrb": 0xF} for _, word in writes]
        first, second = (addresses, words) if ahead == "aw" else (words, addresses)
        await present(dut, **first[0])
        following = cocotb.start_soon(present(dut, **first[1]))
        await ClockCycles(dut.clk, 4)
        for half in second:
            await present(dut, **half)
            assert await take(dut, "b") == Response.OKAY
        await following
        for name, word in writes:
            assert await value(dut, name) == word, name


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def responses_wait(dut: Any) -> None:
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
async def reset_inside_transactions(dut: Any) -> None:
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
async def errors_change_nothing(dut: Any) -> None:
    """Unmapped offsets and writes to ro registers: SLVERR, as the map says, and no effect."""
    async with checked(dut) as checker:
        master = master_of(dut)
        for offset in range(0, 1 << ADDRESS_WIDTH, BYTES):
            register = next((r for r in MAP if r.offset == offset), None)
            before = dict(checker.model.values)
            if register is None or not register.writable:
                response = await response_of(master.write(offset, WORD))
                assert response == Response.SLVERR, f"a write to {offset:#x} passed"
            if not checker.model.is_port(offset):
                response = await response_of(master.read(offset))
                assert response == (Response.OKAY if register else Response.SLVERR), f"a read of {offset:#x}"
            assert checker.model.values == before


async def choose(dut: Any, table: int, index: int) -> None:
    """Set TABLE_SELECT and TABLE_INDEX."""
    await write(dut, OFFSET["TABLE_SELECT"], table)
    await write(dut, OFFSET["TABLE_INDEX"], index)


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(table=list(TABLES.values()))
async def table_entries(dut: Any, table: Any) -> None:
    """Entries are written and read in turn, the index runs round; nothing happens outside, half strobed, in reset."""
    async with checked(dut) as checker:
        size, writes = checker.build.table_sizes[table], checker.model.table_writes
        await write(dut, OFFSET["TABLE_HIGH"], 0x8000_0001)
        await choose(dut, table, 0)
        assert await value(dut, "TABLE_SIZE") == size
        if not size:
            assert await write(dut, OFFSET["TABLE_LOW"], 5) == Response.SLVERR
            for name in ("TABLE_LOW", "TABLE_HIGH"):
                assert await read(dut, OFFSET[name]) == (0, Response.SLVERR)
            assert not writes
            return
        words = [(0x8000_0000, WORD), (0x7FFF_FFFF, 0), (0, 0x8000_0000), (1, 2), (WORD, WORD)]
        first = max(0, size - 2)
        await choose(dut, table, first)
        for high, low in words:
            await write(dut, OFFSET["TABLE_HIGH"], high)
            assert await write(dut, OFFSET["TABLE_LOW"], low) == Response.OKAY
        assert writes == [(table, (first + n) % size, *pair) for n, pair in enumerate(words)]
        assert await value(dut, "TABLE_INDEX") == (first + len(words)) % size
        await write(dut, OFFSET["TABLE_LOW"], 3)  # the upper word stays
        assert writes.pop() == (table, (first + len(words)) % size, WORD, 3)

        await choose(dut, table, first)
        for n in range(5):
            index = (first + n) % size
            assert await value(dut, "TABLE_INDEX") == index
            assert await value(dut, "TABLE_HIGH") == entry(table, index)[0]
            assert await value(dut, "TABLE_LOW") == entry(table, index)[1]

        for bit in range(size.bit_length()):  # neighbours of the last entry
            index = (size - 1) ^ 1 << bit
            if index < size:
                await choose(dut, table, index)
                assert await write(dut, OFFSET["TABLE_LOW"], 5) == Response.OKAY
                assert await value(dut, "TABLE_INDEX") == index + 1
        for strobe in range((1 << BYTES) - 1):
            assert await write(dut, OFFSET["TABLE_LOW"], 5, strobe) == Response.SLVERR, f"strobe {strobe:04b}"
        if size < 1 << checker.build.index_width:
            await choose(dut, table, size)
            assert await write(dut, OFFSET["TABLE_LOW"], 5) == Response.SLVERR
            for name in ("TABLE_LOW", "TABLE_HIGH"):
                assert await read(dut, OFFSET[name]) == (0, Response.SLVERR)
            assert await value(dut, "TABLE_INDEX") == size
            await choose(dut, table, size - 1)
            assert await write(dut, OFFSET["TABLE_LOW"], 5) == Response.OKAY
            assert await value(dut, "TABLE_INDEX") == 0

        # Taken in the clock before a reset, so that it would go out in the reset's first.
        writing = cocotb.start_soon(write(dut, OFFSET["TABLE_LOW"], 9))
        while not (checker.fires("aw") and checker.fires("w")):
            await RisingEdge(dut.clk)
        dut.rst.value = 1
        await RisingEdge(dut.clk)
        assert not dut.table_write.value, "written in reset"
        writing.cancel()


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def no_table_that_the_build_has_not(dut: Any) -> None:
    """Values of TABLE_SELECT that name none of the build's tables."""
    async with checked(dut) as checker:
        await ClockCycles(dut.clk, 3)
        for table in range(1 << REGISTERS["TABLE_SELECT"].field("select").width):
            if checker.build.table_sizes.get(table):
                continue
            await choose(dut, table, 0)
            assert await value(dut, "TABLE_SIZE") == 0
            assert await write(dut, OFFSET["TABLE_LOW"], 5) == Response.SLVERR
            assert await read(dut, OFFSET["TABLE_LOW"]) == (0, Response.SLVERR)
        assert not checker.model.table_writes


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def a_write_beside_a_read_of_a_table(dut: Any) -> None:
    """Writes that come in each clock of a read wait for its end, and the entry read is that of before or after."""
    async with checked(dut) as checker:
        table = min(table for table, size in checker.build.table_sizes.items() if size)
        for lead in range(-3, 8):
            await choose(dut, table, 1)
            await write(dut, OFFSET["TABLE_HIGH"], 77)

            async def writes(lead: Any = lead) -> None:
                await ClockCycles(dut.clk, max(0, lead) + 1)
                assert await write(dut, OFFSET["TABLE_LOW"], 8) == Response.OKAY

            writing = cocotb.start_soon(writes())
            await ClockCycles(dut.clk, max(0, -lead) + 1)
            data, response = await read(dut, OFFSET["TABLE_LOW"])
            assert response == Response.OKAY
            assert data in (entry(table, 1)[1], entry(table, 2)[1])
            await writing
            assert await value(dut, "TABLE_INDEX") == 3
            assert checker.model.table_writes[-1][1] in (1, 2)


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(lag=[0, 1, 7])
async def commits(dut: Any, lag: int) -> None:
    """A change-over comes with the next frame start, is pending until the table has followed, and guards that table."""
    async with checked(dut, lag) as checker:
        COMMIT, has = OFFSET["TABLE_COMMIT"], tables_present(checker.build)

        async def starts() -> None:
            before = int(dut.table_bank.value)
            dut.frame_start.value = 1
            await RisingEdge(dut.clk)  # the checker looks at table_bank in this clock
            dut.frame_start.value = 0
            await ClockCycles(dut.clk, 1)
            changed.append(before ^ int(dut.table_bank.value))

        changed: list[int] = []
        await starts()
        assert changed.pop() == 0
        for tables in range(1, 1 << len(TABLES)):
            await write(dut, COMMIT, tables, strobe=0b1110)
            assert await value(dut, "TABLE_COMMIT") == 0
            await write(dut, COMMIT, tables)
            assert await value(dut, "TABLE_COMMIT") == tables & has
            await write(dut, COMMIT, 0)  # takes nothing back
            for table, size in checker.build.table_sizes.items():
                await choose(dut, table, 0)
                refused = not size or tables >> table & 1
                assert await write(dut, OFFSET["TABLE_LOW"], 1) == (Response.SLVERR if refused else Response.OKAY)
                assert (await read(dut, OFFSET["TABLE_HIGH"]))[1] == (Response.OKAY if size else Response.SLVERR)
            await starts()
            assert changed.pop() == tables & has
            if lag > 3:
                assert await value(dut, "TABLE_COMMIT") == tables & has
            await write(dut, COMMIT, tables if lag > 3 else 0)  # while it is pending: nothing
            await ClockCycles(dut.clk, lag)
            assert await value(dut, "TABLE_COMMIT") == 0
            await starts()
            assert changed.pop() == 0

        one = has & -has  # the first table there is

        # Frame starts around the clock in which the write takes effect: those after it change over.
        for clocks, late in ((0, False), (1, False), (2, True), (3, True)):
            writing = cocotb.start_soon(write(dut, COMMIT, one))
            await ClockCycles(dut.clk, clocks)
            await starts()
            assert changed.pop() == late * one, f"a frame start {clocks} clocks after the write was offered"
            await writing
            if not late:
                assert await value(dut, "TABLE_COMMIT") == one
                await starts()
                assert changed.pop() == one
            await ClockCycles(dut.clk, lag + 2)

        # A reset forgets what no frame has taken, and finishes what one has.
        await write(dut, COMMIT, one)
        await reset(dut)
        assert await value(dut, "TABLE_COMMIT") == 0
        await starts()
        assert changed.pop() == 0
        await write(dut, COMMIT, one)
        await starts()
        assert changed.pop() == one
        bank = int(dut.table_bank.value)
        await reset(dut)
        assert await value(dut, "TABLE_COMMIT") == 0
        assert int(dut.table_bank.value) == int(dut.table_in_use.value) == bank


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def sticky_bits(dut: Any) -> None:
    """Each event sets its own bit, a written 1 clears that bit alone, the live bits follow their inputs."""
    async with checked(dut):
        sources = [(flag, {f"event_{flag}": 1}) for flag in STICKY_EVENTS]
        sources += [("saturation", {"saturations": 1 << bit}) for bit in range(8)]
        for name, inputs in sources:
            await pulse(dut, **inputs)
            assert await value(dut, "STATUS") == STATUS.pack(**{name: 1}), name
            await write(dut, STATUS.offset, WORD & ~STATUS.field(name).mask)
            assert await value(dut, "STATUS") == STATUS.pack(**{name: 1}), f"{name} was cleared by a 0"
            strobe = 0xF ^ 1 << STATUS.field(name).low // 8
            await write(dut, STATUS.offset, STATUS.field(name).mask, strobe)
            assert await value(dut, "STATUS") == STATUS.pack(**{name: 1}), f"{name} was cleared unstrobed"
            await write(dut, STATUS.offset, STATUS.field(name).mask)
            assert await value(dut, "STATUS") == 0, name
        await pulse(dut, **{f"event_{flag}": 1 for flag in EVENT_COUNTERS if flag not in STICKY_EVENTS})
        assert await value(dut, "STATUS") == 0
        for name in LEVELS:
            getattr(dut, name).value = 1
            assert await value(dut, "STATUS") == STATUS.pack(**{name: 1})
            await write(dut, STATUS.offset, WORD)
            assert await value(dut, "STATUS") == STATUS.pack(**{name: 1})
            getattr(dut, name).value = 0


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(register=["STATUS", "CONTROL"])
async def setting_wins_over_clearing(dut: Any, register: str) -> None:
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
async def counters(dut: Any) -> None:
    """Each counts its own event, stays at all ones, and is cleared."""
    async with checked(dut) as checker:
        sources = {name: {f"event_{flag}": 1} for flag, name in EVENT_COUNTERS.items()}
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
async def latency(dut: Any) -> None:
    """The latency last reported stays, through clear_counters too."""
    async with checked(dut):
        for clocks in (0x1234_5678, WORD, 0, 34_567):
            await pulse(dut, first_depth_latency=clocks, first_depth_latency_valid=1)
            await pulse(dut, first_depth_latency=99)
            await write(dut, CONTROL.offset, CONTROL.pack(clear_counters=1))
            assert await value(dut, "FIRST_DEPTH_LATENCY") == clocks


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def each_address_reads_its_own(dut: Any) -> None:
    """Every register with bits of its own, so that another in its place, or two at once, would show at any address."""
    async with checked(dut) as checker:
        rng = random.Random(cocotb.RANDOM_SEED)
        for _ in range(4):
            for name in (*HELD, "TABLE_SELECT", "TABLE_INDEX", "TABLE_HIGH", "CONTROL"):
                await write(dut, OFFSET[name], rng.getrandbits(32) & ~CONTROL.pack(clear_counters=1))
            for register in CAPTURES.values():
                await write(dut, register.offset, register.pack(log2_frames=rng.getrandbits(4)))
            await pulse(dut, first_depth_latency=rng.getrandbits(32), first_depth_latency_valid=1)
            for name, signal in COUNTER_SIGNALS.items():
                checker.model.values[name] = rng.getrandbits(32)
                getattr(dut, signal).value = checker.model.values[name]
            await pulse(dut, **{f"event_{flag}": rng.getrandbits(1) for flag in STICKY_EVENTS}, saturations=1)
            for name in (*LEVELS, "capture_busy", "floor_busy"):
                getattr(dut, name).value = rng.getrandbits(1)
            dut.record.value = rng.getrandbits(32 * len(RECORD))
            await write(dut, OFFSET["TABLE_COMMIT"], WORD)  # from here on all that the build has are pending
            for address in range(0, 1 << ADDRESS_WIDTH, 4):
                await read(dut, address)  # compared by the checker
            for name in (*LEVELS, "capture_busy", "floor_busy"):
                getattr(dut, name).value = 0


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def records(dut: Any) -> None:
    """Each word of the record is read as it stands in that clock, and at its own address."""
    async with checked(dut):
        rng = random.Random(cocotb.RANDOM_SEED)
        for _ in range(3):
            words = [rng.getrandbits(32) for _ in RECORD]
            dut.record.value = sum(word << 32 * n for n, word in enumerate(words))
            assert [await value(dut, name) for name in RECORD] == words


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(name=list(PINS))
async def capture(dut: Any, name: str) -> None:
    """A start goes out once; while the capture is busy its table is closed, and its end asks for the change-over."""
    async with checked(dut) as checker:
        model, table, register, pin = checker.model, TABLES[name], CAPTURES[name], PINS[name]
        bit, busy, done = 1 << table, getattr(dut, f"{pin}_busy"), getattr(dut, f"{pin}_done")
        start = register.pack(start=1, log2_frames=5)
        if not checker.build.table_sizes[table]:
            assert await write(dut, register.offset, start) == Response.SLVERR
            assert await value(dut, register.name) == 0
            assert await write(dut, register.offset, start, strobe=0b1101) == Response.OKAY
            assert await value(dut, register.name) == register.pack(log2_frames=5)
            await pulse(dut, **{f"{pin}_done": 1})
            assert await value(dut, "TABLE_COMMIT") == 0
            assert not model.captures
            return

        assert await write(dut, register.offset, start) == Response.OKAY
        assert (model.captures, await value(dut, register.name)) == ([name], register.pack(log2_frames=5))
        assert await write(dut, register.offset, WORD, strobe=0b1101) == Response.OKAY
        assert await write(dut, register.offset, WORD & ~register.field("start").mask) == Response.OKAY
        assert model.captures == [name]
        busy.value = 1
        assert await value(dut, register.name) == register.pack(log2_frames=15, busy=1)
        assert await write(dut, register.offset, start) == Response.OKAY  # afresh
        assert model.captures == [name, name]
        for other, size in checker.build.table_sizes.items():
            await choose(dut, other, 0)
            refused = other == table or not size
            assert await write(dut, OFFSET["TABLE_LOW"], 1) == (Response.SLVERR if refused else Response.OKAY)
        await write(dut, OFFSET["TABLE_COMMIT"], WORD)
        assert await value(dut, "TABLE_COMMIT") == tables_present(checker.build) & ~bit
        bank = int(dut.table_bank.value)
        await pulse(dut, frame_start=1)
        await ClockCycles(dut.clk, 2)
        assert (int(dut.table_bank.value) ^ bank) & bit == 0
        assert await value(dut, "TABLE_COMMIT") == 0

        # A frame that starts with the end of the capture still uses the table before.
        for together in (True, False):
            bank = int(dut.table_bank.value)
            done.value, dut.frame_start.value = 1, together
            await RisingEdge(dut.clk)
            busy.value = done.value = dut.frame_start.value = 0
            assert await value(dut, "TABLE_COMMIT") == bit
            assert int(dut.table_bank.value) == bank
            later = Response.SLVERR if name == "floor" else Response.OKAY  # its change-over comes behind the solver
            assert await write(dut, register.offset, start) == later
            for other, size in checker.build.table_sizes.items():
                if size and other != table:
                    await choose(dut, other, 0)
                    assert await write(dut, OFFSET["TABLE_LOW"], 1) == Response.OKAY
            await choose(dut, table, 0)
            assert await write(dut, OFFSET["TABLE_LOW"], 1) == Response.SLVERR
            await pulse(dut, frame_start=1)
            await ClockCycles(dut.clk, 2)
            assert int(dut.table_bank.value) == bank ^ bit
            assert await value(dut, "TABLE_COMMIT") == 0
            assert await write(dut, OFFSET["TABLE_LOW"], 1) == Response.OKAY


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(pressure=[0.0, 0.6])
async def random_traffic(dut: Any, pressure: float) -> None:
    """Reads, writes and events at random, responses refused with probability `pressure`."""
    rng = random.Random(cocotb.RANDOM_SEED)
    dut._log.info("SEED=%s", os.environ["COCOTB_RANDOM_SEED"])
    async with checked(dut, lag=5) as checker:
        master = master_of(dut)
        done = False
        since_start = 0

        writable = [register.offset for register in MAP if register.writable] + 6 * [OFFSET["TABLE_LOW"]]

        def any_offset() -> int:
            unmapped_too = range(0, 1 << ADDRESS_WIDTH, BYTES)
            return rng.choice(rng.choice((writable, tuple(OFFSET.values()))) if rng.random() < 0.9 else unmapped_too)

        tables = [table for table, size in checker.build.table_sizes.items() if size]

        def any_data(offset: int) -> int:
            if offset == OFFSET["TABLE_SELECT"] and rng.random() < 0.7:
                return rng.choice(tables)  # what is behind any other number takes no entries
            return rng.choice((rng.getrandbits(32), 1 << rng.randrange(32), rng.getrandbits(4), WORD))

        async def writes() -> None:
            while not done:
                offset = any_offset()
                await response_of(
                    master.write(
                        offset,
                        any_data(offset),
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
            since_start = 0 if since_start > 10 and rng.random() < 0.1 else since_start + 1
            dut.frame_start.value = since_start == 0
            if rng.random() < 0.1:
                dut.busy.value, dut.contact.value = rng.random() < 0.3, rng.random() < 0.5
                dut.touching.value, dut.capture_busy.value = rng.random() < 0.5, rng.random() < 0.5
                dut.record.value = rng.getrandbits(32 * len(RECORD))
            dut.capture_done.value = rng.random() < 0.02
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
        assert set(checker.model.captures) == {name for name in PINS if checker.build.table_sizes[TABLES[name]]}
