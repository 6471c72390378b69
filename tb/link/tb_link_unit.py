# SPDX-License-Identifier: Apache-2.0
"""link_unit against the model of the device: every byte out, every pixel, every register access.

One thing happens at a time, so that the order of packets is that of the model; what happens at once is tested with the
host in tests/device. Line, pixels and registers stall at random.
"""

import random
from collections import deque
from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import RisingEdge

from tactile_depth.chip.contact.contact_events import WORDS, record
from tactile_depth.chip.link import packets as link
from tactile_depth.chip.link.depth_formats import DepthFormat, exact_shift
from tactile_depth.chip.link.device import Build, LinkDevice
from tactile_depth.chip.link.framing import to_line
from tb.axis import VIDEO
from tb.link.axil_slave import AxilSlave, Registers
from tb.pins import Driver, unsigned
from tb.stream import MANY, parameters, parametrize, start_clock
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Rows Columns DataWidth Lanes BottomFirst")
STRUCTURES = (built(6, 16, 24, 1, 1, on=ICARUS), built(5, 32, 15, 4, 0, on=VERILATOR), built(32, 16, 18, 2, 1))
REFUSED = {
    "Rows_must_be_2_to_4096": "Rows=1, Rows=4097",
    "Columns_must_be_a_power_of_two_2_to_4096": "Columns=1, Columns=12, Columns=8192",
    "DataWidth_must_be_2_to_32": "DataWidth=1, DataWidth=33",
    "Lanes_must_divide_Columns": "Lanes=3",
    "AddressWidth_must_be_2_to_16": "AddressWidth=1, AddressWidth=17",
}


QUIET_CLOCKS = 300  # without a byte; a byte too many that comes later differs in the next comparison
LAST_CLOCKS = 2000  # the same behind the last comparison: more than a packet of depth takes until its first byte
LONGEST_CLOCKS = 60_000
CLOCKS_A_BYTE = 4  # of a frame in words, to a line that takes a byte in each clock (docs/link.md)
BROKEN = None  # a byte that could not be received
READ = (
    *(f"{name}{half}" for name in ("in_", "out_", "m_axis_t") for half in ("valid", "ready")),
    *("out_data", *(f"m_axis_t{field}" for field in VIDEO)),
)
REFUSED_ADDRESS = 0x43  # address, which Registers refuses
Byte = int | None


class Board:
    """Device with a line, registers, a sink of pixels, and a pipeline that gives frames; and the model beside it."""

    def __init__(self, dut: Any, stalls: float) -> None:
        self.dut, self.stalls = dut, stalls
        self.chance = random.Random(cocotb.RANDOM_SEED)
        self.rows, self.columns, self.width, self.lanes, bottom_first = parameters(
            dut, "Rows", "Columns", "DataWidth", "Lanes", "BottomFirst"
        )
        self.registers, self.model_registers = (Registers(len(dut.m_axil_araddr)) for _ in range(2))
        build = Build(self.rows, self.columns, self.width, bool(bottom_first))
        self.model = LinkDevice(build, self.model_registers.read, self.model_registers.write)
        self.reads = {name: unsigned(getattr(dut, name)) for name in READ}
        self.drive = Driver(dut)
        self.to_device: deque[Byte] = deque()
        self.beats: deque[tuple[int, int, int]] = deque()
        self.words: deque[tuple[int, int]] = deque()
        self.out: list[int] = []
        self.clock = 0
        self.out_clocks: list[int] = []  # of each byte
        self.duration = 0  # clocks from the first byte to the last of what was compared last
        self.pixels: list[tuple[int, int, int]] = []

    async def start(self) -> None:
        dut = self.dut
        dut.rst.value, dut.cold_rst.value = 1, 1
        self.drive(in_valid=0, in_broken=0, s_axis_tvalid=0, s_event_tvalid=0, out_ready=0, m_axis_tready=0)
        AxilSlave(dut, self.registers, iter(lambda: bool(self.goes()), None), cocotb.RANDOM_SEED)
        start_clock(dut.clk)
        for _ in range(4):
            await RisingEdge(dut.clk)
        dut.rst.value, dut.cold_rst.value = 0, 0
        cocotb.start_soon(self.run())

    def goes(self) -> int:
        return int(self.chance.random() >= self.stalls)

    async def run(self) -> None:
        """Move everything, each clock."""
        edge = RisingEdge(self.dut.clk)
        while True:
            await edge
            self.clock += 1
            self.line()
            self.pipeline()

    def moves(self, name: str) -> bool:
        """Return True if a word passes at the handshake of these pins."""
        return bool(self.reads[f"{name}valid"]() and self.reads[f"{name}ready"]())

    def line(self) -> None:
        """Move a byte each way, and a pixel."""
        taken = self.moves("in_")
        if taken or self.drive.driven["in_broken"]:
            self.to_device.popleft()
        offered = self.drive.driven["in_valid"] and not taken
        pins = {"in_broken": 0, "in_valid": int(offered)}
        if self.to_device and not offered and self.goes():
            byte = self.to_device[0]
            pins = {"in_broken": int(byte is None), "in_valid": int(byte is not None), "in_data": byte or 0}
        if self.moves("out_"):
            self.out.append(self.reads["out_data"]())
            self.out_clocks.append(self.clock)
        pins["out_ready"] = self.goes()
        if self.moves("m_axis_t"):
            data, last, user = (self.reads[f"m_axis_t{field}"]() for field in VIDEO)
            self.pixels.append((data, last, user))
        self.drive(**pins, m_axis_tready=self.goes())

    def pipeline(self) -> None:
        """Give depth and record; what the pipeline gives is never held back."""
        pins = {"s_axis_tvalid": 0, "s_event_tvalid": 0}
        if self.beats and self.goes():
            words = zip(VIDEO, self.beats.popleft(), strict=True)
            pins |= {f"s_axis_t{field}": word for field, word in words} | {"s_axis_tvalid": 1}
        elif self.words and not self.beats and self.goes():
            data, last = self.words.popleft()
            pins |= {"s_event_tdata": data, "s_event_tlast": last, "s_event_tvalid": 1}
        self.drive(**pins)

    # What happens, in device and model.

    def send(self, data: list[Byte]) -> bytes:
        """Send bytes; return what the model answers. A broken byte makes its piece bad, as a wrong one does."""
        self.to_device.extend(data)
        self.model.receive(bytes(0xFF if byte is BROKEN else byte for byte in data))
        return self.answer()

    def answer(self) -> bytes:
        return b"".join(iter(self.model.next_packet, b""))

    def frame(self) -> bytes:
        """Give a frame of the pipeline; return what the model sends of it."""
        limit = 1 << self.width - 1
        codes = np.array(
            [self.chance.choice((self.chance.randrange(-limit, limit), 0, limit - 1, -limit, 1)) for _ in self.places()]
        ).reshape(self.rows, self.columns)
        words = [self.chance.getrandbits(32) for _ in range(WORDS)]
        depth_bits = 8 * -(-self.width // 8)
        for first in range(0, codes.size, self.lanes):
            beat = codes.flat[first : first + self.lanes]
            data = sum((int(code) % (1 << depth_bits)) << place * depth_bits for place, code in enumerate(beat))
            self.beats.append((data, int((first + self.lanes) % self.columns == 0), int(first == 0)))
        self.words.extend((word, int(place == WORDS - 1)) for place, word in enumerate(words))
        self.model.offer(codes.astype(np.int32), record(words))
        return self.answer()

    def places(self) -> range:
        return range(self.rows * self.columns)

    async def compare(self, expected: bytes, what: str, quiet_clocks: int = QUIET_CLOCKS) -> None:
        """Wait until everything has been sent, and compare bytes, pixels and registers."""
        quiet = 0
        for _ in range(LONGEST_CLOCKS):
            before = len(self.out)
            await RisingEdge(self.dut.clk)
            busy = self.to_device or self.beats or self.words or len(self.out) < len(expected)
            busy = busy or len(self.pixels) < len(self.model.pixels)
            busy = busy or len(self.registers.log) < len(self.model_registers.log)
            quiet = 0 if busy or len(self.out) != before else quiet + 1
            if quiet > quiet_clocks:
                break
        assert bytes(self.out).hex(" ") == expected.hex(" "), what
        assert self.pixels == [tuple(word) for word in self.model.pixels], what
        assert self.registers.log == self.model_registers.log, what
        self.duration = self.out_clocks[-1] - self.out_clocks[0] if self.out else 0
        self.out.clear()
        self.out_clocks.clear()
        self.pixels.clear()
        self.model.pixels.clear()

    async def reset(self) -> bytes:
        self.dut.rst.value = 1
        for _ in range(3):
            await RisingEdge(self.dut.clk)
        self.dut.rst.value = 0
        self.to_device.clear()
        self.model.reset()
        return self.answer()

    def request(self) -> list[Byte]:
        """Return the line's bytes of some packet other than ask and select."""
        chance = self.chance
        addresses = tuple(chance.choice((4, 8, 8, REFUSED_ADDRESS, 1 << 15)) for _ in range(chance.choice((1, 2, 5))))
        return list(
            to_line(
                chance.choice(
                    [
                        link.Read(chance.randrange(4), addresses).pack(),
                        link.Write(
                            chance.randrange(4), tuple((each, chance.getrandbits(32)) for each in addresses)
                        ).pack(),
                        bytes((0x22,)) + chance.randbytes(chance.choice((0, 300, 1100))),  # unknown kind
                        bytes((link.Kind.WRITE, 1, *range(chance.randrange(8)))),
                        bytes((link.Kind.READ, 1)) + bytes(2 * 129),
                        bytes((link.Kind.SELECT, 4, 0)),
                        bytes((link.Kind.PICTURE, 1, 2, 3, 4, 0, 0, 0, 0, 1, 2)),
                    ]
                )
            )
        )

    def damaged(self, line: list[Byte]) -> list[Byte]:
        """Return the bytes with one lost, doubled, flipped or broken, and a delimiter behind them."""
        place = self.chance.randrange(1, len(line) - 1)
        byte = line[place]
        assert byte is not None
        flipped: Byte = byte ^ self.chance.choice([bit for bit in (1, 16, 128) if byte != bit])
        new: list[Byte] = self.chance.choice([[], [byte, byte], [flipped], [BROKEN]])
        return [*line[:place], *new, *line[place + 1 :]]

    def picture(self, number: int) -> list[list[Byte]]:
        """Return the line's bytes of the packets of a picture."""
        count = self.rows * self.columns
        pixels = self.chance.randbytes(link.PIXEL_BYTES * count)
        sizes = [self.chance.randint(1, min(link.MOST_PIXELS, count)) for _ in range(count)]
        packets: list[list[Byte]] = []
        first = 0
        for size in sizes:
            part = pixels[3 * first : 3 * (first + size)]
            if part:
                packets.append(list(to_line(link.Picture(number, *divmod(first, self.columns), part).pack())))
            first += size
        return packets


@cocotb.test(timeout_time=20, timeout_unit="ms")
@parametrize(stalls=[0.0, 0.4])
async def one_after_another(dut: Any, stalls: float) -> None:
    """Compare each answer: requests, damaged ones, selections, frames in each format, resets."""
    board = Board(dut, stalls)
    await board.start()
    chance = board.chance
    await board.compare(board.answer(), "power-up")
    for turn in range(MANY + 3):
        depth_format = DepthFormat(turn % 4)
        select = link.Select(depth_format, chance.choice((0, 3, exact_shift(board.width), 16)))
        await board.compare(board.send(list(to_line(select.pack()))), f"select {depth_format}")
        expected = board.frame()
        await board.compare(expected, f"frame of {select}")
        if not stalls and depth_format == DepthFormat.WORDS:
            assert board.duration <= CLOCKS_A_BYTE * len(expected)
        expected = b"".join(board.send(board.request()) for _ in range(3))
        await board.compare(expected, "requests")
        expected = b"".join(board.send(board.damaged(board.request())) for _ in range(4))
        await board.compare(expected, "damaged requests")
        await board.compare(board.send(list(to_line(link.Ask().pack()))), "counts")
        if turn % 3 == 2:
            await board.compare(await board.reset(), "reset")
    await board.compare(b"", "nothing more", LAST_CLOCKS)


@cocotb.test(timeout_time=20, timeout_unit="ms")
@parametrize(stalls=[0.0, 0.4])
async def pictures(dut: Any, stalls: float) -> None:
    """Compare pixels: whole pictures, such that lack a packet, begin again, or repeat a packet."""
    board = Board(dut, stalls)
    await board.start()
    await board.compare(board.answer(), "power-up")
    for number in range(MANY):
        packets = board.picture(number)
        lost = board.chance.randrange(len(packets))
        again = board.chance.randrange(len(packets))
        for some in (packets[:lost] + packets[lost + 1 :], packets, packets[: again + 1] + packets[again:]):
            expected = b"".join(board.send(packet) for packet in some)
            await board.compare(expected, f"picture {number}")
    await board.compare(b"", "nothing more", LAST_CLOCKS)
