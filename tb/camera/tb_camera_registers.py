# SPDX-License-Identifier: Apache-2.0
"""Checks hdl/camera/camera_registers.sv against its model, every output in every clock."""

from __future__ import annotations

import random
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, RisingEdge

from tactile_depth.camera.camera_registers import COUNTERS, STATUS, CameraRegisters, Setup
from tactile_depth.camera.camera_window import FAULTS
from tactile_depth.registers.axil_port import BYTES, AxilPort, Response, response, strobed_bits
from tactile_depth.registers.register_map import ADDRESS_WIDTH, CAMERA_MAP, CAMERA_REGISTERS, WORD
from tb import axil, structs
from tb.registers import axil_pins
from tb.stream import CLOCK_NS, REGRESS

PARAMETERS = (
    *("PictureColumns", "PictureRows", "WindowX", "WindowY", "BlackLevel", "RedGain", "GreenGain", "BlueGain"),
    *("WindowColumns", "WindowRows", "Format", "Bits", "Phase"),
)
EVENTS = ("faults", "frames_lost")
SETUP = ("setup_done", "setup_failed", "setup_entry", "setup_found")
UNUSED = ("s_axil_awprot", "s_axil_arprot")
OFFSET = {register.name: register.offset for register in CAMERA_MAP}
RANDOM_CLOCKS = 10_000 if REGRESS else 2_000


class Checker:
    """Follows the pins, feeds the model with them, and compares every output in every clock."""

    def __init__(self, dut: Any) -> None:
        self.dut, self.port, self.clocks = dut, AxilPort(), 0
        self.model = CameraRegisters({name: int(getattr(dut, name).value) for name in PARAMETERS})
        self.restarts = 0

    def pin(self, name: str) -> int:
        return int(getattr(self.dut, name).value)

    async def run(self) -> None:
        """Compare until the test ends, from the end of the first reset on."""
        edge = RisingEdge(self.dut.clk)
        await edge
        while True:
            await edge
            self.step()
            self.clocks += 1

    def step(self) -> None:
        """Compare the outputs of one clock."""
        model, port, offered = self.model, self.port, axil_pins.pins(self.dut)
        resets = bool(self.pin("rst"))
        outputs = axil_pins.expected(port, resets) | {"settings": structs.pack("camera_settings_t", model.settings)}
        offset, writes = port.read(offered), port.write()
        setup = Setup(*map(bool, map(self.pin, SETUP[:2])), *map(self.pin, SETUP[2:]))
        answer = (0, Response.OKAY) if offset is None else model.read(offset, setup)
        refused, restart = False, False
        if writes is not None and not resets:
            assert port.data is not None
            result, restart = model.write(writes.offset, *port.data)
            refused = result != Response.OKAY
        self.restarts += restart
        for name, value in (outputs | {"setup_restart": int(restart)}).items():
            got = self.pin(name)
            assert got == value, f"clock {self.clocks}: {name} is {got:#x}, expected {value:#x}"
        faults = structs.unpack("camera_faults_t", self.pin("faults"))
        model.clock([name for name in FAULTS if faults[name]], self.pin("frames_lost"))
        if resets:
            model.reset()
            port.reset()
        else:
            port.clock(offered, refused, answer, False, (0, Response.OKAY))


async def reset(dut: Any) -> None:
    """Hold the reset for two clocks."""
    dut.rst.value = 1
    await ClockCycles(dut.clk, 2)
    dut.rst.value = 0


@asynccontextmanager
async def checked(dut: Any) -> AsyncIterator[Checker]:
    """Clock and reset the registers, and compare them with their model until the end of the block."""
    for name in (*axil_pins.INPUTS, *UNUSED, *EVENTS, *SETUP):
        getattr(dut, name).value = 0
    dut.rst.value = 1
    Clock(dut.clk, CLOCK_NS, unit="ns", impl="gpi").start(start_high=False)
    checker = Checker(dut)
    follower = cocotb.start_soon(checker.run())
    await reset(dut)
    yield checker
    await ClockCycles(dut.clk, 3)
    assert checker.clocks > 4
    follower.cancel()


async def value_of(dut: Any, name: str) -> int:
    data, answered = await axil.read(dut, OFFSET[name])
    assert answered == Response.OKAY, f"reading {name} is answered {answered}"
    return data


async def pulse(dut: Any, **events: int) -> None:
    """Raise events for one clock; return when registers show them."""
    for name, value in events.items():
        getattr(dut, name).value = value
    await RisingEdge(dut.clk)
    for name in events:
        getattr(dut, name).value = 0
    await ClockCycles(dut.clk, 2)


def fault(name: str) -> int:
    return structs.pack("camera_faults_t", {name: 1})


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def reset_values(dut: Any) -> None:
    """Settings have the values of the build; every other field has that of the map."""
    async with checked(dut) as checker:
        for register in CAMERA_MAP:
            data = await value_of(dut, register.name)
            assert data == checker.model.values[register.name]
            for field in register.fields:
                if field.reset is not None:
                    assert register.unpack(data)[field.name] == field.reset, field.name


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(name=list(CAMERA_REGISTERS))
async def access(dut: Any, name: str) -> None:
    """Each field has the access of the map, byte by byte."""
    register = CAMERA_REGISTERS[name]
    async with checked(dut):
        for strobe in range(1 << BYTES):
            for word in (WORD, 0, 0x5AA5_C33C):
                before = await value_of(dut, name)
                got = await axil.write(dut, register.offset, word, strobe)
                assert got == response(not register.writable)
                mask = strobed_bits(strobe) & register.mask("rw")
                if not register.mask("w1c"):
                    assert await value_of(dut, name) == word & mask | before & ~mask


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def offsets(dut: Any) -> None:
    """Refuse registers that are not listed, and addresses that differ from a register in one bit."""
    async with checked(dut) as checker:
        values = dict(checker.model.values)
        near = {offset ^ 1 << bit for offset in OFFSET.values() for bit in range(2, ADDRESS_WIDTH)}
        for offset in sorted(near | set(range(0, 1 << ADDRESS_WIDTH, 64))) if REGRESS else sorted(near):
            if offset not in OFFSET.values():
                assert await axil.write(dut, offset, WORD) == Response.SLVERR
                assert (await axil.read(dut, offset))[1] == Response.SLVERR
        assert checker.model.values == values


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def events(dut: Any) -> None:
    """Each fault has its bit and counts once; lost frames count as many as there are; a 1 clears its bit alone."""
    async with checked(dut):
        for number, name in enumerate(FAULTS, 1):
            await pulse(dut, faults=fault(name))
            assert await value_of(dut, "CAMERA_DROPPED") == number
        assert await value_of(dut, "CAMERA_STATUS") == STATUS.pack(**dict.fromkeys(FAULTS, 1))
        await pulse(dut, frames_lost=255)
        await pulse(dut, frames_lost=2)
        assert await value_of(dut, "CAMERA_LOST") == 257
        for field in (*FAULTS, "lost"):
            before = await value_of(dut, "CAMERA_STATUS")
            await axil.write(dut, STATUS.offset, STATUS.field(field).mask)
            assert await value_of(dut, "CAMERA_STATUS") == before & ~STATUS.field(field).mask
        assert await value_of(dut, "CAMERA_STATUS") == 0


async def preset(checker: Checker, **values: int) -> None:
    """Set counters, by their registers in the RTL and in the model."""
    await RisingEdge(checker.dut.clk)
    for name, value in values.items():
        getattr(checker.dut, name).value = value
    await RisingEdge(checker.dut.clk)
    checker.model.values.update({f"CAMERA_{name.upper()}": value for name, value in values.items()})


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def counters_have_32_bits(dut: Any) -> None:
    """They count on from any value, and stay at the largest."""
    async with checked(dut) as checker:
        rng = random.Random(cocotb.RANDOM_SEED)
        values = [(1 << bit) - 1 for bit in range(1, 33)] + [
            WORD - 1,
            WORD - 200,
            *(rng.getrandbits(32) for _ in range(2)),
        ]
        for value in values:
            await preset(checker, dropped=value, lost=value)
            await pulse(dut, faults=fault("row_long"), frames_lost=200)
            assert await value_of(dut, "CAMERA_DROPPED") == min(value + 1, WORD)
            assert await value_of(dut, "CAMERA_LOST") == min(value + 200, WORD)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def an_event_in_the_clock_of_a_clearing_write_is_kept(dut: Any) -> None:
    async with checked(dut) as checker:
        control = CAMERA_REGISTERS["CAMERA_CONTROL"]
        await preset(checker, dropped=WORD, lost=WORD)
        dut.faults.value, dut.frames_lost.value = fault("row_short"), 3
        await axil.write(dut, control.offset, control.field("clear_counters").mask)
        dut.faults.value, dut.frames_lost.value = 0, 0
        await ClockCycles(dut.clk, 2)
        assert 0 < await value_of(dut, "CAMERA_DROPPED") < 8
        assert await value_of(dut, "CAMERA_LOST") == 3 * await value_of(dut, "CAMERA_DROPPED")


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def set_up(dut: Any) -> None:
    """A written 1 restarts it for one clock; what it says is read as it stands."""
    async with checked(dut) as checker:
        control = CAMERA_REGISTERS["CAMERA_CONTROL"]
        for word, restarts in ((control.mask(), 1), (1, 1), (2, 2), (WORD & ~2, 2)):
            await axil.write(dut, control.offset, word)
            assert checker.restarts == restarts
        for values in ((1, 0, 0x55, 0xAA), (0, 1, 0xAA, 0x55)):
            for name, value in zip(SETUP, values, strict=True):
                getattr(dut, name).value = value
            assert await value_of(dut, "CAMERA_SETUP") == values[2] | values[3] << 8
            status = STATUS.unpack(await value_of(dut, "CAMERA_STATUS"))
            assert (status["setup_done"], status["setup_failed"]) == values[:2]


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(pressure=[0.0, 0.5])
async def random_traffic(dut: Any, pressure: float) -> None:
    """Random accesses, events and resets; responses are refused a ready with probability `pressure`."""
    rng = random.Random(cocotb.RANDOM_SEED)
    addresses = [*OFFSET.values(), *OFFSET.values(), *range(0x100, 0x140, 4), 0, 0x10]
    async with checked(dut) as checker:
        valid = {channel: getattr(dut, f"s_axil_{channel}valid") for channel in ("aw", "w", "ar")}
        for _ in range(RANDOM_CLOCKS):
            for channel, wire in valid.items():
                if not wire.value or axil_pins.pin(dut, f"{channel}ready") or dut.rst.value:
                    wire.value = rng.random() < 0.6
            dut.s_axil_awaddr.value = rng.choice(addresses) | rng.randrange(4)
            dut.s_axil_araddr.value = rng.choice(addresses) | rng.randrange(4)
            dut.s_axil_wdata.value = rng.choice((WORD, 0, rng.getrandbits(32), 1 << rng.randrange(32)))
            dut.s_axil_wstrb.value = rng.choice((0xF, rng.getrandbits(4)))
            dut.s_axil_awprot.value, dut.s_axil_arprot.value = rng.randrange(8), rng.randrange(8)
            dut.faults.value = rng.choice((0, 0, fault(rng.choice(FAULTS))))
            dut.frames_lost.value = rng.choice((0, 0, 1, rng.randrange(256)))
            for name in SETUP:
                pin = getattr(dut, name)
                pin.value = rng.getrandbits(len(pin))
            dut.rst.value = rng.random() < 0.005
            dut.s_axil_bready.value, dut.s_axil_rready.value = (rng.random() >= pressure for _ in range(2))
            await RisingEdge(dut.clk)
        dut.rst.value = 0
        assert checker.restarts
        assert all(name in checker.model.values for name in COUNTERS)
