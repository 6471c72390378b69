# SPDX-License-Identifier: Apache-2.0
"""picture_pixels against the model of the device: packets of any size, some of them lost, twice, or wrong."""

import random
from typing import Any

import cocotb
from cocotb.triggers import ClockCycles, RisingEdge

from formal.entries import Proof
from tactile_depth.chip.link.device import Build, LinkDevice
from tactile_depth.chip.link.framing import to_line
from tactile_depth.chip.link.packets import MOST_PIXELS, Picture
from tb.axis import AxisMonitor, AxisSink, AxisSource, profile
from tb.cases import on_bench
from tb.pins import Driver, unsigned
from tb.stream import MANY, parameters, parametrize, start_clock
from tb.structures import ICARUS, VERILATOR, Mutants, of_parameters

built = of_parameters("Rows Columns")
STRUCTURES = (
    built(12, 16, on=VERILATOR),
    built(3, 4, on=ICARUS, mutants=ICARUS),
    built(
        5,
        6,
    ),
    built(2, 300),
)
PROTOCOL = {
    "stays": "picture_",
    "counts": "live & ~reset",
    "m_axis_tdata m_axis_tlast m_axis_tuser": "counts & m_axis_tvalid",
}
MUTANTS = Mutants(repeats=4)
PROOFS = (
    Proof(
        "rows and columns are only counted",
        {"Rows": 2, "Columns": 3},
    ),
)


LONGEST = 5_000  # clocks until all pixels have left


class Bench:
    """Bench of a host that sends pictures, whose video is compared with that of the model."""

    def __init__(self, dut: Any, stalls: str = "none") -> None:
        self.dut = dut
        self.random = random.Random(cocotb.RANDOM_SEED)
        self.rows, self.columns = parameters(dut, "Rows", "Columns")
        self.size = self.rows * self.columns
        dut.rst.value = 1
        self.source = AxisSource(dut, "picture", ("data", "last"), offers=profile(stalls, 1))
        AxisSink(dut, "m_axis", "t", accepts=profile(stalls, 2))
        self.monitor = AxisMonitor(dut, "m_axis", prefix="t")

    async def start(self) -> None:
        start_clock(self.dut.clk)
        await self.reset()

    async def reset(self) -> None:
        self.source.abort()
        self.dut.rst.value = 1
        await ClockCycles(self.dut.clk, 2)
        self.dut.rst.value = 0
        await RisingEdge(self.dut.clk)
        self.monitor.forget()
        self.device = LinkDevice(Build(self.rows, self.columns, 24, False), lambda _: None, lambda _, __: False)

    def packet(self, number: int, first: int, count: int) -> Picture:
        """Return a packet of random pixels."""
        pixels = bytes(self.random.getrandbits(8) for _ in range(3 * count))
        return Picture(number, *divmod(first, self.columns), pixels)

    def picture(self, number: int, longest: int) -> list[Picture]:
        """Return the packets of a picture; the last one may go on behind its end."""
        packets, first = [], 0
        while first < self.size:
            count = self.random.randint(1, longest)
            packets.append(self.packet(number, first, count))
            first += count
        return packets

    async def send(self, *packets: Picture) -> None:
        """Send packets to the core and to the model."""
        for packet in packets:
            self.device.receive(to_line(packet.pack()))
            body = packet.pack()[1:]
            await self.source.send([(byte, int(place == len(body) - 1)) for place, byte in enumerate(body)])

    async def check(self) -> None:
        """Wait for the pixels, and compare them with the model."""
        edge = RisingEdge(self.dut.clk)
        for _ in range(LONGEST):
            if len(self.monitor.words) >= len(self.device.pixels):
                break
            await edge
        await ClockCycles(self.dut.clk, 5)
        assert self.monitor.words == self.device.pixels


FIELDS = (("number", 32), ("row", 16), ("column", 16))  # of the header, with their bits


def with_a_bit_changed(packet: Picture, field: str, bit: int) -> Picture:
    """Return the packet with one bit of its number, row or column changed."""
    changed: dict[str, Any] = {field: getattr(packet, field) ^ 1 << bit}
    return packet._replace(**changed)


@on_bench(Bench, milliseconds=0.6)
@parametrize(stalls=["none", "random", "alternate", "one_in_4"])
async def pictures(bench: Bench, stalls: str) -> None:
    """Send pictures of which packets are lost, come twice, or have a wrong bit in their header, and whole ones."""
    size = bench.size
    for picture in range(max(4, min(4 * MANY, 3000 // size))):
        longest = bench.random.choice([1, 3, bench.columns, size + 2])
        number = bench.random.choice([picture, bench.random.getrandbits(32)])
        packets = bench.picture(number, min(max(longest, size // 40), MOST_PIXELS))
        for _ in range(bench.random.choice([0, 0, 1, 2])):
            place = bench.random.randrange(len(packets))
            match bench.random.randrange(4):
                case 0:
                    del packets[place]
                case 1:
                    packets.insert(place, packets[place])
                case 2:
                    field, width = bench.random.choice(FIELDS)
                    packets[place] = with_a_bit_changed(packets[place], field, bench.random.randrange(width))
                case 3:
                    packets.insert(place, bench.packet(number, bench.random.randrange(size + 3), 2))
            if not packets:
                break
        await bench.send(*packets)
    await bench.check()
    ends = [place for place, word in enumerate(bench.monitor.words) if word.user]
    assert len(ends) > 1, "the test is void: no picture followed another"


@on_bench(Bench, milliseconds=0.6)
async def each_bit_of_a_header_counts(bench: Bench) -> None:
    """Send a packet that would go on but for one bit of its header, and one that would begin but for one bit."""
    for number in (0, 0xFFFF_FFFF, bench.random.getrandbits(32)):
        half = bench.size // 2
        for field, width in FIELDS:
            for bit in range(width):
                begins, goes_on = bench.packet(number, 0, min(half, 3)), bench.packet(number, min(half, 3), 1)
                await bench.send(begins, with_a_bit_changed(goes_on, field, bit))
                if field != "number":
                    await bench.send(with_a_bit_changed(begins, field, bit))
                await bench.send(goes_on)
    await bench.check()


@on_bench(Bench, milliseconds=0.6)
async def a_byte_counts_while_it_is_valid(bench: Bench) -> None:
    """Send pictures with other bytes on the pins between theirs, and what would go on if those had begun a picture."""
    drive, ready, edge = Driver(bench.dut), unsigned(bench.dut.picture_ready), RisingEdge(bench.dut.clk)
    for number in range(8):
        other = bench.packet(number << 4 * number, 0, 2)
        behind = [other._replace(column=256), other._replace(row=bench.rows)]
        for packet in [*bench.picture(number << 4 * number, 3), *behind]:
            bench.device.receive(to_line(packet.pack()))
            body = packet.pack()[1:]
            for place, byte in enumerate(body):
                other_byte = bench.random.choice([0, bench.random.getrandbits(8)])
                drive(picture_data=other_byte, picture_last=bench.random.getrandbits(1))
                await edge
                drive(picture_data=byte, picture_last=place == len(body) - 1, picture_valid=1)
                await edge
                while not ready():
                    await edge
                drive(picture_valid=0)
    await bench.check()


@on_bench(Bench, milliseconds=0.6)
async def what_is_behind_the_end_is_dropped(bench: Bench) -> None:
    """Send pixels behind the end, in the packet of the last pixel and in packets that would go on there."""
    step = max(1, bench.size // 8)
    for number in range(3):
        for first in range(0, bench.size, step):
            await bench.send(bench.packet(number, first, step + number if first + step >= bench.size else step))
        for row, column in ((bench.rows, 0), (0, bench.size), (bench.rows - 1, bench.columns), (0, 1)):
            await bench.send(bench.packet(number, 0, 2)._replace(row=row, column=column))
    await bench.check()
    assert len(bench.monitor.words) == 3 * bench.size


@on_bench(Bench, milliseconds=0.6)
async def resets(bench: Bench) -> None:
    """Reset in every clock of a packet: its picture does not go on, and the next one is whole."""
    count = min(bench.size // 2, 3)
    for clocks in range(1, 8 + 4 * count):
        await bench.send(bench.packet(5, 0, count))
        cocotb.start_soon(bench.send(bench.packet(5, count, count)))
        await ClockCycles(bench.dut.clk, clocks)
        await bench.reset()
        await bench.send(bench.packet(5, count, 1), bench.packet(5, 0, count), bench.packet(5, count, 1))
        await bench.check()


@on_bench(Bench)
async def latency(bench: Bench) -> None:
    """Offer a pixel the clock after its last byte."""
    dut, taken, offered = bench.dut, [], []

    async def watch() -> None:
        while True:
            await RisingEdge(dut.clk)
            taken.append(int(dut.picture_valid.value and dut.picture_ready.value))
            offered.append(int(dut.m_axis_tvalid.value))

    cocotb.start_soon(watch())
    await bench.send(bench.packet(1, 0, 2))
    await bench.check()
    bytes_taken = [clock for clock, one in enumerate(taken) if one]
    assert [clock for clock, one in enumerate(offered) if one] == [bytes_taken[10] + 1, bytes_taken[13] + 1]
