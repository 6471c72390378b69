# SPDX-License-Identifier: Apache-2.0
"""camera_setup against its model in every cycle, with a camera on its lines that also fails."""

import itertools
import random
from collections.abc import Callable
from functools import partial
from typing import Any

import cocotb
from cocotb.triggers import ClockCycles, ReadOnly, RisingEdge

from formal.entries import Proof
from formal.tables import camera_list
from tactile_depth.chip.camera.camera_setup import CameraSetup, Entry, Kind, Outputs
from tactile_depth.chip.camera.register_lists import Camera, setup_parameters, write_list
from tb.camera.sccb_camera import SccbCamera
from tb.cases import on_bench
from tb.pins import by_name
from tb.settings import RUN
from tb.stream import REGRESS, parameters, parametrize, sample, start_clock
from tb.structures import BOTH, ICARUS, Structure

Fault = Callable[[str, int, int], int | None]
COUNTS = ("AddressBytes", "DeviceId", "QuarterClocks", "MillisecondClocks", "Attempts")


# Lists with each kind of entry, for registers of one and of two bytes.
LISTS = {
    "short": (
        Entry(Kind.PINS, 2, 2),
        Entry(Kind.PINS, 1, 0),
        Entry(Kind.CHECK, 0x0A, 0x76),
        Entry(Kind.PLAIN_WRITE, 0x12, 0x80),
        Entry(Kind.WRITE, 0xA5, 0x5A),
        Entry(Kind.PINS, 1, 1),
        Entry(Kind.WRITE, 0x03, 0xFF),
    ),
    "wide": (
        Entry(Kind.PINS, 2, 0xA5),
        Entry(Kind.PINS, 1, 0),
        Entry(Kind.CHECK, 0x300A, 0x56),
        Entry(Kind.PLAIN_WRITE, 0x3008, 0x82),
        Entry(Kind.WRITE, 0xC35A, 0x01),
        Entry(Kind.WRITE, 0x3CA5, 0xFE),
    ),
}

TIMES = {"QuarterClocks": 4, "MillisecondClocks": 3, "XclkHalfClocks": 2, "Attempts": 4}


def built(entries: str, **runs: Any) -> Structure:
    device = {"short": (1, 0x42), "wide": (2, 0x78)}[entries]
    camera = Camera(entries, *device, picture=(1, 1), bayer="bggr", frames_per_s=1, entries=LISTS[entries])
    return Structure(
        {**setup_parameters(camera), **TIMES},
        device={"list": entries},
        roms=partial(write_list, entries=camera.entries),
        name=entries,
        **runs,
    )


STRUCTURES = (
    built("short", on=BOTH),
    built("wide", on=ICARUS, mutants=ICARUS),
)
PROTOCOL = {"counts": "live"}
REFUSED = {
    "AddressBytes_must_be_1_or_2": "AddressBytes=3",
    "QuarterClocks_must_be_at_least_4_the_line_takes_three_to_be_seen": "QuarterClocks=3",
    "MillisecondClocks_and_Entries_must_be_at_least_2_XclkHalfClocks_and_Attempts_1": "Entries=1, Attempts=0",
    "DeviceId_must_be_an_even_byte": "DeviceId=67, DeviceId=256",
}
PROOFS = (
    Proof(
        "a list with every kind of entry",
        {"Bus": 0},
        roms=camera_list,
        free=("sent", "caught"),
    ),
)


class Bench:
    """Device, its model in step with it, and a camera on its lines."""

    def __init__(self, dut: Any, faults: Fault | None = None, acknowledges: bool = True) -> None:
        self.dut, self.read, self.list = dut, by_name(dut), LISTS[RUN.device["list"]]
        self.address_bytes, self.device_id, quarter, millisecond, attempts = parameters(dut, *COUNTS)
        self.model = CameraSetup(self.list, self.address_bytes, self.device_id, quarter, millisecond, attempts)
        checks = {entry.address: entry.data for entry in self.list if entry.kind == Kind.CHECK}
        self.camera = SccbCamera(self.device_id, self.address_bytes, checks, acknowledges)
        if faults is not None:
            self.camera.faults = faults

    async def start(self) -> None:
        dut = self.dut
        dut.rst.value, dut.restart.value, dut.sio_d.value = 1, 0, 1
        start_clock(dut.clk)
        await ClockCycles(dut.clk, 4)
        cocotb.start_soon(self.follow())
        await RisingEdge(dut.clk)
        dut.rst.value = 0

    async def follow(self) -> None:
        """Compare every output in every cycle, and let the camera drive the line."""
        dut, read, edge = self.dut, self.read, RisingEdge(self.dut.clk)
        expected, driven = None, None
        while True:
            await edge
            if expected is not None:
                self.compare(expected)
            self.model.edge(read("sio_d"), bool(read("rst") or read("restart")))
            expected = self.model.outputs
            levels = int(expected.sio_c), int(not expected.sio_d_low)
            line = levels[1] & self.camera.follow(levels[0], levels[1] & self.camera.line)
            if line != driven:  # a write costs more than a read
                dut.sio_d.value = driven = line

    def compare(self, expected: Outputs) -> None:
        known = [name for name in Outputs._fields if name != "found" or expected.found is not None]
        got = {name: self.read(name) for name in known}
        assert got.items() <= expected._asdict().items(), f"{got}, expected {expected}"

    async def end(self) -> None:
        """Wait until the list has ended, with or without a fault."""
        edge = RisingEdge(self.dut.clk)
        while not (self.read("done") or self.read("failed")):
            await edge
        await ClockCycles(self.dut.clk, 3)

    def check_registers(self) -> None:
        """Compare every register with the last value that the list writes to it."""
        last = {entry.address: entry.data for entry in self.list if entry.kind in (Kind.WRITE, Kind.PLAIN_WRITE)}
        assert {address: self.camera.registers.get(address) for address in last} == last


@on_bench(Bench, milliseconds=20)
@parametrize(acknowledges=[True, False])
async def whole_list(bench: Bench) -> None:
    """Play the whole list: every register arrives, whatever the camera drives in the ninth bit, and the pins end as the
    list says."""
    await bench.end()
    assert bench.dut.done.value
    assert not bench.dut.failed.value
    bench.check_registers()
    last = [entry.address for entry in bench.list if entry.kind == Kind.PINS][-1]
    assert (int(bench.dut.power_down.value) << 1 | int(bench.dut.reset_n.value)) == last
    sent = [len(data) for data in bench.camera.transmissions]
    address_bytes = bench.address_bytes
    expected = {Kind.WRITE: [2 + address_bytes, 1 + address_bytes, 2], Kind.CHECK: [1 + address_bytes, 2]}
    expected |= {Kind.PLAIN_WRITE: [2 + address_bytes], Kind.PINS: []}
    assert sent == [count for entry in bench.list for count in expected[entry.kind]]


@cocotb.test(timeout_time=20, timeout_unit="ms")
@parametrize(kind=["write", "read", "silent"], times=sample([1, 2, 3]))
async def faults_that_end(dut: Any, kind: str, times: int) -> None:
    """Lose a write, answer with a wrong bit, or give no answer: the entry is sent again until it is right."""
    count: dict[int, int] = {}
    chance = random.Random(cocotb.RANDOM_SEED)

    def faults(what: str, address: int, value: int) -> int | None:
        if what == ("write" if kind == "write" else "read"):
            count[address] = count.get(address, 0) + 1
            if count[address] <= times:
                return value ^ 1 << chance.randrange(8) if kind == "read" else None
        return value

    bench = Bench(dut, faults)
    await bench.start()
    await bench.end()
    if kind == "write":  # a lost write that is not read back stays undetected
        plain = {entry.address for entry in bench.list if entry.kind == Kind.PLAIN_WRITE}
        for address in plain - {entry.address for entry in bench.list if entry.kind == Kind.WRITE}:
            bench.camera.registers[address] = next(e.data for e in bench.list if e.address == address)
    assert dut.done.value
    bench.check_registers()


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def faults_that_stay(dut: Any) -> None:
    """Let an entry fail always: the list ends after the set number of attempts, with the entry's number and the value
    read."""
    list_of = LISTS[RUN.device["list"]]
    attempts = parameters(dut, "Attempts")[0]
    compared = [index for index, entry in enumerate(list_of) if entry.kind in (Kind.WRITE, Kind.CHECK)]
    bench, wrong = Bench(dut), 0
    await bench.start()
    for place in compared if REGRESS else (compared[0], compared[-1]):
        broken = list_of[place].address
        reads = [index for index in compared if list_of[index].address == broken]
        wrong = list_of[reads[0]].data ^ 0x10

        def faults(what: str, address: int, value: int, broken: int = broken, wrong: int = wrong) -> int | None:
            return wrong if what == "read" and address == broken else value

        bench.camera.faults = faults
        bench.camera.transmissions.clear()
        dut.restart.value = 1
        await RisingEdge(dut.clk)
        dut.restart.value = 0
        await ClockCycles(dut.clk, 2)
        await bench.end()
        assert dut.failed.value
        assert not dut.done.value
        assert (int(dut.entry.value), int(dut.found.value)) == (reads[0], wrong)
        reading = [data for data in bench.camera.transmissions if len(data) == 2 and data[0] & 1]
        assert reading[-attempts:] == [[bench.device_id | 1, wrong]] * attempts
    bench.camera.faults = lambda what, address, value: value
    dut.restart.value = 1
    await RisingEdge(dut.clk)
    dut.restart.value = 0
    await ClockCycles(dut.clk, 2)
    await bench.end()
    assert dut.done.value


@on_bench(Bench, milliseconds=20)
@parametrize(pin=["rst", "restart"])
async def begun_afresh(bench: Bench, pin: str) -> None:
    """Reset or restart at any time: the list begins with its first entry and is completed."""
    chance = random.Random(cocotb.RANDOM_SEED)
    for _ in range(12 if REGRESS else 4):
        await ClockCycles(bench.dut.clk, chance.randint(1, 3000))
        getattr(bench.dut, pin).value = 1
        await ClockCycles(bench.dut.clk, chance.randint(1, 3))
        getattr(bench.dut, pin).value = 0
    await ClockCycles(bench.dut.clk, 2)
    await bench.end()
    assert bench.dut.done.value
    bench.check_registers()


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def camera_clock(dut: Any) -> None:
    """Check that XCLK has its period in every state, and stands still in a reset."""
    (half,) = parameters(dut, "XclkHalfClocks")
    bench = Bench(dut)
    await bench.start()
    levels = []
    for _ in range(40 * half):
        await RisingEdge(dut.clk)
        await ReadOnly()
        levels.append(int(dut.xclk.value))
    edges = [index for index, (a, b) in enumerate(itertools.pairwise(levels)) if a != b]
    assert {b - a for a, b in itertools.pairwise(edges)} == {half}
    await RisingEdge(dut.clk)
    dut.rst.value = 1
    await ClockCycles(dut.clk, 2)
    for _ in range(3 * half):
        await RisingEdge(dut.clk)
        assert not dut.xclk.value
