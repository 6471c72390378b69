# SPDX-License-Identifier: Apache-2.0
"""register_access against the model of the device: the same accesses and replies, whatever streams and port do."""

import random
from typing import Any

import cocotb
from cocotb.triggers import ClockCycles, RisingEdge

from formal.entries import Proof
from tactile_depth.chip.link.device import Build, LinkDevice
from tactile_depth.chip.link.framing import to_line
from tactile_depth.chip.link.packets import Ask, PacketReader, Read, ReadReply, Write, WriteReply
from tb.axis import AxisMonitor, AxisSink, AxisSource, profile
from tb.cases import on_bench
from tb.link.axil_slave import AxilSlave, Registers
from tb.stream import MANY, parameters, parametrize, start_clock
from tb.structures import BOTH, ICARUS, Mutants, of_parameters

built = of_parameters("AddressWidth Accesses")
STRUCTURES = (built(10, 128, on=BOTH), built(4, 3, on=ICARUS, mutants=ICARUS), built(16, 128))
MUTANTS = Mutants(repeats=2)
PROOFS = (Proof("accesses are only counted, and no value is looked at; td_ram is proven by itself", free=("word",)),)


Request = Read | Write
LONGEST = 5_000  # clocks until all replies have left


class Bench:
    """Bench of a host that sends requests, and of a port; each access and reply is compared with the model."""

    def __init__(self, dut: Any, stalls: str = "none") -> None:
        self.dut = dut
        self.random = random.Random(cocotb.RANDOM_SEED)
        self.width, self.accesses = parameters(dut, "AddressWidth", "Accesses")
        dut.rst.value, dut.forget.value = 1, 0
        self.source = AxisSource(dut, "request", ("data", "last", "write"), offers=profile(stalls, 1))
        AxisSink(dut, "reply", accepts=profile(stalls, 2))
        self.monitor = AxisMonitor(dut, "reply", ("data", "last"))
        self.slave = AxilSlave(dut, Registers(self.width), profile(stalls, 3), cocotb.RANDOM_SEED)
        self.begin_anew()

    def begin_anew(self) -> None:
        """Take a new model of the device, and new registers behind the port."""
        self.expected: list[tuple[int, int]] = []
        self.monitor.forget()
        self.slave.registers = Registers(self.width)
        self.model_registers = Registers(self.width)
        build = Build(16, 16, 24, bottom_first=False)
        self.device = LinkDevice(build, self.model_registers.read, self.model_registers.write)

    async def start(self) -> None:
        start_clock(self.dut.clk)
        await self.reset()

    async def reset(self, clocks: int = 2) -> None:
        self.source.abort()
        self.dut.rst.value = 1
        await ClockCycles(self.dut.clk, clocks)
        self.dut.rst.value = 0
        await RisingEdge(self.dut.clk)
        self.begin_anew()

    def model(self, packet: Request | Ask) -> None:
        """Give a packet to the model, and append the bytes of its reply."""
        self.device.receive(to_line(packet.pack()))
        for reply in PacketReader().feed(b"".join(iter(self.device.next_packet, b""))):
            if isinstance(reply, ReadReply | WriteReply):
                body = reply.pack()
                self.expected += [(byte, int(place == len(body) - 1)) for place, byte in enumerate(body)]

    async def send(self, packet: Request | Ask) -> None:
        """Send a packet to the core and to the model."""
        self.model(packet)
        if isinstance(packet, Ask):
            self.dut.forget.value = 1
            await RisingEdge(self.dut.clk)
            self.dut.forget.value = 0
            return
        body = packet.pack()[1:]
        write = int(isinstance(packet, Write))
        await self.source.send([(byte, int(place == len(body) - 1), write) for place, byte in enumerate(body)])

    async def check(self) -> None:
        """Wait for the replies, and compare them and the accesses with the model."""
        edge = RisingEdge(self.dut.clk)
        for _ in range(LONGEST):
            if len(self.monitor.words) >= len(self.expected):
                break
            await edge
        await ClockCycles(self.dut.clk, 5)
        assert self.monitor.words == self.expected
        assert self.slave.registers.log == self.model_registers.log

    def address(self, refused: float) -> int:
        """Return an address that is refused with this probability, by the port or for a bit above its width."""
        good = self.random.getrandbits(self.width) & ~3 | self.random.randrange(3)
        if self.random.random() >= refused:
            return good
        above = self.random.randrange(self.width, 16) if self.width < 16 and self.random.random() < 0.5 else None
        return good | 3 if above is None else good | 1 << above

    def request(self, number: int, count: int, refused: float = 0.0) -> Request:
        """Return a random request of `count` accesses."""
        addresses = tuple(self.address(refused) for _ in range(count))
        if self.random.random() < 0.5:
            return Read(number, addresses)
        return Write(number, tuple((address, self.random.getrandbits(32)) for address in addresses))


@on_bench(Bench, milliseconds=0.3)
@parametrize(stalls=["none", "random", "long"])
async def requests(bench: Bench, stalls: str) -> None:
    """Send requests with and without refused accesses, many of them with the number of the one before, and asks."""
    number = 0
    for _ in range(min(30 * MANY, 120)):
        if bench.random.random() < 0.6:
            number = bench.random.choice([number ^ 1 << bench.random.randrange(8), bench.random.randrange(256)])
        if bench.random.random() < 0.2:
            await bench.send(Ask())
        count = bench.random.randint(1, min(bench.accesses, 6))
        await bench.send(bench.request(number, count, bench.random.choice([0.0, 0.0, 0.3])))
        if bench.random.random() < 0.3:
            await ClockCycles(bench.dut.clk, bench.random.randint(1, 60))
    await bench.check()


@on_bench(Bench, milliseconds=0.3)
async def the_longest_request(bench: Bench) -> None:
    """Send requests of as many accesses as a packet holds, twice each; then one that is refused at the last."""
    for number in range(4):
        request = bench.request(number, bench.accesses)
        for _ in range(2):
            await bench.send(request)
    addresses = [bench.address(0.0) for _ in range(bench.accesses)]
    await bench.send(Read(4, (*addresses[:-1], addresses[-1] | 3)))
    await bench.check()


@on_bench(Bench, milliseconds=0.3)
async def a_number_is_of_its_kind(bench: Bench) -> None:
    """Send a read and a write of the same number in turn, and each bit of the number changed: all are done."""
    for number in [0, *(1 << bit for bit in range(8)), 0]:
        await bench.send(Read(number, (4, 8)))
        await bench.send(Write(number, ((4, number), (8, 1))))
    await bench.check()


@on_bench(Bench, milliseconds=0.3)
async def each_bit_above_is_refused(bench: Bench) -> None:
    """Access an address with each single bit: those above the width end the request without an access."""
    for bit in range(16):
        await bench.send(Read(2 * bit, (0, 1 << bit & ~3, 0)))
        await bench.send(Write(2 * bit + 1, ((0, 1), (1 << bit & ~3, 1 << 2 * bit), (0, 2))))
    await bench.check()


@on_bench(Bench, milliseconds=0.3)
async def forgotten_at_any_time(bench: Bench) -> None:
    """Ask in every clock behind a request, also while its accesses are done and its reply leaves."""
    for clocks in range(24):
        for request in (Read(7, (4, 8)), Write(7, ((4, 1),))):
            await bench.send(request)
            await ClockCycles(bench.dut.clk, clocks + 1)
            await bench.send(Ask())
            await bench.send(request)
            await bench.send(request)
    await bench.check()


@cocotb.test(timeout_time=0.3, timeout_unit="ms")
@parametrize(stalls=["none", "random"])
async def resets(dut: Any, stalls: str) -> None:
    """Reset in every clock of a request: nothing of it is left, and the same number is done again."""
    bench = Bench(dut, stalls)
    await bench.start()
    for clocks in range(1, 45):
        for request in (Read(9, (4, 8, 12)), Write(9, ((4, 1), (8, 2)))):
            await bench.send(request)
            await bench.check()
            cocotb.start_soon(bench.source.send([(byte, 0, clocks % 2) for byte in range(1, 7)]))
            await ClockCycles(dut.clk, clocks)
            await bench.reset(1 + clocks % 2)
            await bench.send(request)
            await bench.check()


@on_bench(Bench)
async def latency(bench: Bench) -> None:
    """Offer an access 2 clocks after its last byte; the reply follows the last answer at once."""
    dut, valids = bench.dut, []

    async def watch() -> None:
        while True:
            await RisingEdge(dut.clk)
            taken = int(dut.request_valid.value and dut.request_ready.value)
            answered = int(dut.m_axil_rvalid.value and dut.m_axil_rready.value)
            valids.append((taken, int(dut.m_axil_arvalid.value), answered, int(dut.reply_valid.value)))

    cocotb.start_soon(watch())
    await bench.send(Read(1, (4,)))
    await bench.check()
    last_byte = max(clock for clock, (taken, *_) in enumerate(valids) if taken)
    offered = next(clock for clock, (_, offered, *_) in enumerate(valids) if offered)
    answer = next(clock for clock, (_, _, answered, _) in enumerate(valids) if answered)
    reply = next(clock for clock, (*_, reply) in enumerate(valids) if reply)
    assert (offered - last_byte, reply - answer) == (2, 1)
