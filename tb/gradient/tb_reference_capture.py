# SPDX-License-Identifier: Apache-2.0
"""reference_capture against its model: sums and gains in a memory, requests at any time, broken frames, the cycle of
done. The memory of the bench refuses accesses whose result hdl/common/td_ram.sv leaves undefined."""

import itertools
from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import RisingEdge

from formal.entries import Proof
from tactile_depth.chip.common.td_block_sum import CYCLES_TO_SUM
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.reference_capture import (
    reference_capture,
    reference_capture_clocks,
    reference_capture_parameters,
)
from tactile_depth.chip.limits import DARKEST_LOG2
from tb.cases import on_bench
from tb.common.capture_bench import request, request_after
from tb.pins import by_name
from tb.pixels import pack
from tb.stream import REGRESS, Bench, StreamDriver, configuration, parameters, parametrize, raster, sample, send_apart
from tb.structures import ICARUS, VERILATOR, Structure


def built(columns: int, rows: int, largest: int, gain_width: int, **runs: Any) -> Structure:
    """Return a structure; `largest` is the binary logarithm of the largest number of frames."""
    choices: dict[str, Any] = {"columns": columns, "rows": rows, "solver": "tridiagonal", "gain_width": gain_width}
    return Structure(
        reference_capture_parameters(Configuration(**choices)) | {"MaxLog2": largest},
        device={"configuration": choices},
        **runs,
    )


STRUCTURES = (
    built(16, 8, 5, 24, on=VERILATOR),
    built(16, 8, 2, 17, on=ICARUS, mutants=ICARUS),
    built(16, 16, 3, 24),
    built(32, 21, 3, 24),
    built(128, 8, 4, 24),
    built(128, 8, 3, 17),
    built(16, 8, 8, 24),
)
PROTOCOL = {
    "raster_places": {},
    "in_position": "in_valid & ~rst ? place : in_position",
    "counts": "live & ~reset",
    "map_write_node map_write_gains": "counts & map_write",
    "map_read_node": "counts & map_read",
}
PROOFS = tuple(
    Proof(
        "a cut row of blocks; rows, columns and frames are only counted; sums are exact at any width"
        + (", whatever the divider writes behind them" if sums else ""),
        {"Sums": sums},
        free=("word",) if sums else (),
    )
    for sums in (0, 1)
)


PIXELS = 512  # that a test sends, about
SUM_CLOCKS = CYCLES_TO_SUM + 1  # from a pixel to its sum in the memory
FIELDS = ["pixel", "position", "bad"]


class Capture:
    """Device, its memory, and the content that is expected when the capture is done."""

    def __init__(self, dut: Any, gap: float = 0.0, pause: float = 0.0) -> None:
        self.dut, self.gap, self.read = dut, gap, by_name(dut)
        self.config = configuration()
        (self.largest,) = parameters(dut, "MaxLog2")
        self.clocks = reference_capture_clocks(self.config)
        self.places = raster(self.config.rows, self.config.columns)
        self.bench = Bench(dut, pause)
        self.chance = self.bench.random
        self.generator = np.random.default_rng(cocotb.RANDOM_SEED)
        self.driver = StreamDriver(dut, "in", "valid", FIELDS)
        nodes = self.config.reference_nodes[0] * self.config.reference_nodes[1]
        self.memory: list[Any] = [None] * nodes
        self.busy = self.inside = False
        self.due: Any = None
        self.gains: Any = None  # cycle of done, and the content of the memory then
        self.divided = 0  # nodes whose gain was written
        self.captures = 0
        self.taken: list[Any] = []  # frames since the request: pixels, bad, log2_frames
        self.frame: Any = None  # frame that is being sent: pixels, bad
        self.flipped: Any = None  # content that a test put into the memory before the last frame
        self.sums: list[Any] = []  # expected writes: (node, sum of a row of the block, whether it begins a sum)
        self.passing = 0  # cycles in which sums from before a request may still be written
        dut.request.value, dut.log2_frames.value = 0, 0

    async def start(self) -> None:
        await self.bench.start()
        cocotb.start_soon(self.run())

    async def run(self) -> None:
        """Check each cycle against the rules in the header of the core."""
        read, edge = self.read, RisingEdge(self.dut.clk)
        for clock in itertools.count():
            await edge
            if read("rst"):
                self.busy = self.inside = False
                self.due = None
                self.sums = []
                continue
            self.serve()
            done = clock == self.due
            assert read("done") == done, f"done is {read('done')}, {self.due and self.due - clock} clocks off"
            assert read("busy") == self.busy
            if done:
                self.captures += 1
                self.busy = False
                self.due = None
                width = self.config.gain.width
                got = [[word >> width * c & (1 << width) - 1 for c in range(3)] for word in self.memory]
                np.testing.assert_array_equal(got, self.gains.reshape(-1, 3), "gains")
            if read("en") and read("in_valid"):
                place = read("in_position")
                if place & 3 == 3:
                    self.inside = self.busy and self.due is None
                    if self.inside:
                        self.sums += self.row_sums(self.frame[0], not self.taken or self.taken[-1][1])
                        self.taken.append((*self.frame, read("log2_frames")))
                if place & 12 == 12 and self.inside:
                    captured = reference_capture(*zip(*self.taken, strict=True), self.largest, self.config)  # type: ignore[arg-type, call-arg]
                    if captured:
                        self.due, self.gains, self.divided = clock + self.clocks, captured[1], 0
                        if self.flipped is not None:
                            self.gains = self.gains_behind_flips(self.taken[-1][0])
            if read("request"):
                self.busy = True
                self.due = None
                self.inside = False
                self.taken, self.sums, self.passing = [], [], SUM_CLOCKS

    def serve(self) -> None:
        pin = self.read
        reads, writes = pin("map_read"), pin("map_write")
        if writes:
            node, gains = pin("map_write_node"), pin("map_write_gains")
            assert not (reads and pin("map_read_node") == node), f"node {node} is read while it is written"
            assert self.busy, "a write after done"
            if self.passing:
                pass
            elif self.sums:
                wanted, added, first = self.sums.pop(0)
                width = self.config.gain.width
                before = [0 if first else self.memory[node] >> width * c for c in range(3)]
                sums = [held + more & (1 << width) - 1 for held, more in zip(before, added, strict=True)]
                word = sum(word << width * c for c, word in enumerate(sums))
                assert (node, gains) == (wanted, word), "a sum"
            else:
                assert self.due is not None, "a write that is not expected"
                assert node == self.divided, f"gain of node {node}, not {self.divided}"
                self.divided += 1
        self.passing = max(0, self.passing - 1)
        if reads:
            word = self.memory[pin("map_read_node")]
            assert word is not None, "a node is read before it was written"
            self.dut.map_read_gains.value = word
        if writes:
            self.memory[node] = gains

    def pixels(self) -> Any:
        """Return pixels, uint8 (rows, columns, 3): random, black, white, nearly black, or with gains about to
        saturate."""
        shape = (self.config.rows, self.config.columns, 3)
        match self.chance.randrange(6):
            case 0:
                return np.full(shape, self.chance.choice((0, 255)), np.uint8)
            case 1:
                return (self.generator.random(shape) < 0.1).astype(np.uint8)
            case 2:
                darkest = 1 << DARKEST_LOG2  # the mean at which a gain just saturates
                return (darkest + self.generator.choice([-1, 0, 0, 0, 0, 0, 0, 1], shape)).astype(np.uint8)
            case 3:
                return np.broadcast_to(self.generator.integers(0, 256, 3, dtype=np.uint8), shape)
        return self.generator.integers(0, 256, shape, dtype=np.uint8)

    def row_sums(self, frame: Any, first: Any) -> Any:
        """Return the writes of a frame in order: node, colours of a block's row, whether they begin a sum."""
        block = 1 << self.config.reference_block_log2
        rows, columns = self.config.reference_nodes
        in_blocks = frame[: rows * block, : columns * block].astype(np.int64)
        sums = in_blocks.reshape(rows * block, columns, block, 3).sum(axis=2)
        return [
            (row // block * columns + column, sums[row, column].tolist(), first and row % block == 0)
            for row in range(rows * block)
            for column in range(columns)
        ]

    def gains_behind_flips(self, frame: Any) -> Any:
        """Return the gains of the sums: words of the memory plus sums of the last frame, modulo their width."""
        block = 1 << self.config.reference_block_log2
        rows, columns = self.config.reference_nodes
        in_blocks = frame[: rows * block, : columns * block].astype(np.int64)
        sums = in_blocks.reshape(rows, block, columns, block, 3).sum(axis=(1, 3)).reshape(-1, 3)
        sums = sums + self.flipped & (1 << self.config.gain.width) - 1
        dividend = 2 * len(self.taken) * block * block << self.config.gain.fraction
        return np.minimum((dividend // np.maximum(sums, 1) + 1) >> 1, (1 << self.config.gain.width) - 1)

    async def send(self, bad: Any = False) -> None:
        """Send a frame."""
        self.frame = (self.pixels(), bad)
        pixels = pack(self.frame[0]).ravel().tolist()
        marks = [bad if place & 12 == 12 else self.chance.randrange(2) for place in self.places]
        await send_apart(self.bench, self.driver, list(zip(pixels, self.places, marks, strict=True)), self.gap)

    request = request

    async def until_done(self, bad: Any = 0.0) -> None:
        """Send frames until the capture is done and the current frame has ended."""
        before = self.captures
        while self.captures == before:
            await self.send(self.chance.random() < bad)


@on_bench(Capture, milliseconds=100)
@parametrize((("gap", "pause"), [(0.0, 0.0), (0.3, 0.3)]), ("log2", sample([0, 3, 1])))
async def captures(device: Capture, gap: float, log2: int) -> None:
    """Capture frames in a row, with and without broken ones between."""
    await device.send()
    if len(device.places) > PIXELS and (log2 > 1 or gap):
        return
    for bad in (0.0, 0.3):
        await device.request(log2)
        await device.until_done(bad)
    assert device.captures == 2


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def most_frames(dut: Any) -> None:
    """Ask for more frames than fit the sum, and change the exponent during the capture."""
    device = Capture(dut, 0.0, 0.0)
    if len(device.places) << device.largest > 128 * PIXELS:
        return
    await device.start()
    await device.request(15)
    await device.send()
    dut.log2_frames.value = 0
    await device.until_done()
    assert len(device.taken) >= 1 << device.largest


@cocotb.test(timeout_time=100, timeout_unit="ms")
async def any_sum(dut: Any) -> None:
    """Put random sums into the memory before the last frame, because frames this small do not reach all bits of a
    sum."""
    device = Capture(dut, 0.0, 0.0)
    if len(device.places) > PIXELS:
        return
    await device.start()
    count = 10 if REGRESS else 4
    for _ in range(count):
        await device.request(1)
        await device.send()
        for _ in range(8):  # until its last sum is written
            await RisingEdge(dut.clk)
        device.flipped = device.generator.integers(0, 1 << device.config.gain.width, (len(device.memory), 3))
        for node, (red, green, blue) in enumerate(device.flipped.tolist()):
            device.memory[node] = red | green << device.config.gain.width | blue << 2 * device.config.gain.width
        await device.until_done()
    assert device.captures == count


@on_bench(Capture, milliseconds=200)
@parametrize(pause=[0.0, 0.4])
async def requests_at_any_time(device: Capture) -> None:
    """Request a capture while idle, armed, summing and dividing, and in the cycles of a frame's first pixel, its last
    pixel and done."""
    size = len(device.places)
    waits = [0, 1, 2, 3, 5, size - 1, size, size + 1, size + 2, size + 3, size + 4, size + 5, 2 * size]
    waits += [size + device.clocks + offset for offset in (-90, -30, -4, -3, -2, -1, 0, 1, 2)]
    waits += [device.chance.randrange(size + device.clocks) for _ in range(5)]
    if size > PIXELS:
        waits = device.chance.sample(waits, 1)
    elif not REGRESS:
        waits = device.chance.sample(waits, len(waits) // 3)
    await request_after(device, waits, size)


@on_bench(Capture, milliseconds=100)
async def resets(device: Capture) -> None:
    """Reset during a capture: it ends, nothing is written after it, and the next request is served."""
    size = len(device.places)
    counts = [1, 2, 3, 4, 5, 6, size - 1, size, size + 1, size + 3, size + 4, size + 90, size + device.clocks - 2]
    for count in counts if size <= PIXELS else []:
        await device.request(0)
        sender = cocotb.start_soon(device.send())
        for _ in range(count):
            await RisingEdge(device.dut.clk)
        await device.bench.reset()
        if not sender.done():
            await sender
        for _ in range(8):
            await RisingEdge(device.dut.clk)
    await device.request(0)
    await device.until_done()
