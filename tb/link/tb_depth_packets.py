# SPDX-License-Identifier: Apache-2.0
"""depth_packets against the packets of the models: every format, sinks of every kind, resets.

The testbench is the store: it holds a frame, and answers reads as depth_store does.
"""

import random
import zlib
from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import RisingEdge

from formal.entries import Proof
from tactile_depth.chip.contact.contact_events import WORDS, record
from tactile_depth.chip.link.depth_formats import DepthFormat, sent_shape, span_of, to_bytes, value_bytes
from tactile_depth.chip.link.packets import LARGEST_SHIFT, Depth, Trailer
from tb.axis import PROFILES, profile
from tb.cases import on_bench
from tb.pins import Driver, by_name
from tb.stream import MANY, parameters, parametrize, start_clock
from tb.structures import ICARUS, VERILATOR, Mutants, of_parameters

built = of_parameters("Rows Columns DataWidth BottomFirst Values")
STRUCTURES = (
    built(9, 32, 24, 1, 256, on=VERILATOR),
    built(5, 4, 24, 0, 8, on=ICARUS),
    built(3, 4, 17, 1, 4, on=ICARUS, mutants=ICARUS),
    built(3, 2, 12, 1, 2),
    built(2, 8, 32, 0, 16),
    built(6, 16, 8, 0, 32),
)
MUTANTS = Mutants(repeats=1, flat=False)
PROOFS = (
    Proof(
        "positions are one formula for every power of two of columns; rounding is proven of depth_value, and the CRC "
        "is a function that the bench uses too",
        {"Rows": 3, "Columns": 2, "Values": 2},
        steps=8,
    ),
)


FORMATS = (DepthFormat.WORDS, DepthFormat.SHORT, DepthFormat.AVERAGED)
LONGEST_SILENCE = 9  # clocks
LOAD_CLOCKS = 6  # of a value of one code
TRAILER_WAITS = WORDS  # a clock before each word of the record


class Bench:
    """Store of a frame, and sink of the packets."""

    def __init__(self, dut: Any, accepts: str = "none") -> None:
        self.dut, self.drive, self.read = dut, Driver(dut), by_name(dut)
        self.edge, self.ready, self.always_ready = RisingEdge(dut.clk), profile(accepts), accepts == "none"
        self.chance = random.Random(cocotb.RANDOM_SEED)
        names = "Rows", "Columns", "DataWidth", "BottomFirst", "Values"
        self.rows, self.columns, self.width, self.bottom_first, self.values = parameters(dut, *names)
        self.codes = np.zeros((self.rows, self.columns), np.int32)
        self.words: tuple[int, ...] = (0,) * WORDS
        self.resets = self.sent = 0
        self.many = MANY if self.codes.size < 64 else 0  # frames of a large grid take long

    async def start(self) -> None:
        start_clock(self.dut.clk)
        self.drive(frame_valid=0, format=0, shift=0, depth_ready=0, value_data=0, record_data=0, cold_rst=0, resets=0)
        await self.reset(cold=True)

    async def reset(self, cold: bool = False, offered: bool = False) -> None:
        """Reset for a clock, with or without a frame that waits in it."""
        self.drive(rst=1, cold_rst=cold, frame_valid=offered, format=1, depth_ready=self.chance.randrange(2))
        await self.edge
        self.resets = self.chance.getrandbits(16)
        self.drive(rst=0, cold_rst=0, frame_valid=0, resets=self.resets)
        self.packets: list[bytes] = []
        self.packet = b""
        self.reading, self.silent = False, 0
        self.held: tuple[int, bool] | None = None  # a byte that was offered and not taken
        self.pending: list[int | None] = [None, None]  # values that were read in the last two clocks
        self.reads: list[int] = []  # addresses of the values that were read
        self.waits = 0  # clocks without a byte while a frame is sent
        self.sent = 0 if cold else self.sent

    def offer(self, depth_format: DepthFormat, shift: int) -> list[bytes]:
        """Let a frame wait; return its packets. Codes are any, the extremes, or near a tie."""
        low, high = -(1 << self.width - 1), (1 << self.width - 1) - 1
        shape = (self.rows, self.columns)
        numbers = np.random.default_rng(self.chance.getrandbits(32))
        halves = numbers.integers(-3, 4, shape) * (1 << shift) // 2 + numbers.integers(-1, 2, shape)
        kinds = [np.clip(halves, low, high), numbers.integers(low, high + 1, shape), numbers.choice([low, high], shape)]
        self.codes = np.choose(numbers.integers(0, 3, shape), kinds).astype(np.int32)
        self.words = tuple(self.chance.getrandbits(32) for _ in range(WORDS))
        self.drive(frame_valid=1, format=int(depth_format), shift=shift)
        return self.expected(depth_format, 0 if depth_format == DepthFormat.WORDS else shift)

    def expected(self, depth_format: DepthFormat, shift: int) -> list[bytes]:
        """Return the packets of the frame, the next one to be numbered."""
        self.sent = (self.sent + 1) % (1 << 32)
        values = to_bytes(self.codes, depth_format, self.width, shift)
        rows, columns = sent_shape(depth_format, self.rows, self.columns)
        size = value_bytes(depth_format, self.width)
        packets = [
            Depth(depth_format, self.sent, *divmod(first, columns), values[first * size :][: self.values * size]).pack()
            for first in range(0, rows * columns, self.values)
        ]
        words, crc, from_bottom = record(self.words), zlib.crc32(values), bool(self.bottom_first)
        trailer = Trailer(self.sent, self.resets, depth_format, shift, rows, columns, from_bottom, crc, words)
        return [*packets, trailer.pack()]

    async def clock(self) -> None:
        """Run a clock: take a byte, answer reads."""
        read, ready = self.read, int(next(self.ready))
        self.drive(depth_ready=ready)
        await self.edge
        valid = bool(read("depth_valid"))
        if valid:
            byte = read("depth_data"), bool(read("depth_last"))
            assert self.held in (None, byte), "a byte changed before it was taken"
            self.held = None if ready else byte
            if ready:
                self.packet += bytes((byte[0],))
                if byte[1]:
                    self.packets, self.packet = [*self.packets, self.packet], b""
        else:
            assert self.held is None, "valid fell before ready came"
        self.silent = 0 if valid or not read("sending") else self.silent + 1
        self.waits += self.silent > 0
        assert self.silent <= LONGEST_SILENCE, f"a byte waits for more than {LONGEST_SILENCE} clocks"
        self.store()

    def store(self) -> None:
        """Do as depth_store does in the clock that ends: a value stands until the next one that is read."""
        take, done, reads = (bool(self.read(pin)) for pin in ("frame_take", "frame_done", "value_read"))
        value, self.pending = self.pending[0], [self.pending[1], None]
        if value is not None:
            self.drive(value_data=value % (1 << self.width))
        if self.reading:
            self.drive(record_data=self.words[self.read("record_word") % WORDS])
        if reads:
            self.reads.append(self.read("value_address"))
            assert self.reading, "no frame is taken"
            assert not done, "the frame is given back"
            self.pending[1] = int(self.codes.flat[self.reads[-1]])
        if take:
            assert self.read("frame_valid"), "no frame waits"
            assert not self.reading, "a frame is taken"
            shift = self.chance.randrange(LARGEST_SHIFT + 1)
            self.drive(frame_valid=0, format=self.chance.randrange(4), shift=shift)
        assert not done or self.reading
        self.reading = take or (self.reading and not done)

    def moves(self) -> bool:
        """Return True if a frame is taken or sent."""
        return any(map(self.read, ("frame_take", "sending", "depth_valid")))

    async def clocks(self, count: int) -> None:
        for _ in range(count):
            await self.clock()

    async def play(self, depth_format: DepthFormat, shift: int) -> None:
        """Send a frame, and compare its packets, and what the core says of it."""
        want = self.offer(depth_format, shift)
        await self.clock()
        assert self.read("frame_take"), "a frame waits"
        self.packets, self.reads, self.waits = [], [], 0
        await self.clock()
        while self.read("sending"):
            assert self.read("sent") == self.sent
            await self.clock()
        await self.clock()
        assert not self.packet
        assert self.packets == want, f"{[p.hex() for p in self.packets]}, expected {[p.hex() for p in want]}"
        assert not self.reading, "the frame was not given back"
        rows, columns = sent_shape(depth_format, self.rows, self.columns)
        span = span_of(depth_format)
        places = np.arange(self.codes.size).reshape(self.codes.shape)[: span * rows, : span * columns]
        in_order = places.reshape(rows, span, columns, span).swapaxes(1, 2)
        assert self.reads == in_order.ravel().tolist(), "each code is read once, in its order"
        values, codes = rows * columns, span * span
        if self.always_ready:
            assert self.waits == (LOAD_CLOCKS + codes - 1) * values + TRAILER_WAITS


@on_bench(Bench, milliseconds=20)
@parametrize(accepts=[*PROFILES])
async def frames(bench: Bench) -> None:
    """Send frames of every format with several shifts."""
    for depth_format in FORMATS:
        some = [bench.chance.randrange(LARGEST_SHIFT + 1) for _ in range(1 + bench.many)]
        for shift in [0, LARGEST_SHIFT, *some] if bench.many else some:
            await bench.play(depth_format, shift)
            await bench.clocks(bench.chance.randrange(3))


@on_bench(Bench, milliseconds=20)
async def not_taken(bench: Bench) -> None:
    """Let a frame wait with format 0: it is not taken until there is another format."""
    bench.offer(DepthFormat.SHORT, 2)
    bench.drive(format=0)
    bench.sent -= 1
    for _ in range(5):
        await bench.clock()
        assert not bench.moves()
    await bench.play(DepthFormat.AVERAGED, 3)


@on_bench(Bench, milliseconds=20, accepts="one_in_4")
async def resets(bench: Bench) -> None:
    """Reset at any byte of a frame: it is given up, the number stays, and the next frame is whole."""
    dut = bench.dut
    for index in range(4 + 12 * bench.many):
        depth_format = bench.chance.choice(FORMATS)
        await bench.play(depth_format, 1)
        bytes_of = sum(map(len, bench.offer(depth_format, 4)))
        await bench.clocks(bench.chance.randrange(2, 4 * bytes_of))
        cold = index % 4 == 3
        await bench.reset(cold, offered=index % 2 == 1)
        for _ in range(10):
            await bench.clock()
            assert not bench.moves()
            assert int(dut.sent.value) == bench.sent
