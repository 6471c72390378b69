# SPDX-License-Identifier: Apache-2.0
"""zero_capture against its model in every cycle: each write in its cycle, requests at any time, resets."""

import itertools
from collections import deque
from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import RisingEdge

from formal.entries import ROUNDING, Proof
from tactile_depth.chip.common.td_node_map import side
from tactile_depth.chip.depth.zero_capture import LARGEST_LOG2, captured_zero, cycles, levels
from tb.cases import on_bench
from tb.common.capture_bench import request, request_after
from tb.depth_frames import DepthDriver, depth_words, packed, random_depths
from tb.nodes import Grid
from tb.pins import by_name
from tb.stream import REGRESS, Bench, parameters, parametrize, sample
from tb.structures import ICARUS, VERILATOR, Structure


def built(*case: int, **runs: Any) -> Structure:
    names = ("Columns", "Rows", "BlockLog2", "Width", "MaxLog2", "Lanes")
    return Structure(dict(zip(names, case, strict=True)), **runs)


STRUCTURES = (
    built(
        16,
        8,
        1,
        24,
        5,
        1,
        on=VERILATOR,
    ),
    built(32, 13, 2, 20, 3, 4, on=VERILATOR),
    built(4, 5, 1, 4, 2, 1, on=ICARUS, mutants=ICARUS),
    built(4, 2, 1, 6, 1, 1, on=ICARUS),
    built(16, 11, 2, 5, 2, 2, on=ICARUS),
    built(16, 5, 1, 4, 1, 4, on=ICARUS, mutants=ICARUS),
    built(32, 21, 1, 12, 1, 1),
    built(16, 16, 2, 24, 3, 1),
    built(128, 20, 3, 16, 1, 1),
    built(16, 9, 1, 32, 0, 1),
    built(
        16,
        8,
        1,
        24,
        LARGEST_LOG2,
        1,
    ),
    built(128, 20, 3, 24, 2, 8),
    built(256, 9, 3, 24, 1, 32),
    built(128, 17, 3, 24, 1, 32),
    built(256, 9, 3, 24, 1, 64),
)
PROTOCOL = {
    "raster_places": {"Columns": "Columns / Lanes"},
    "in_frame_start": "in_valid & ~rst ? &place[1:0] : in_frame_start",
    "in_frame_end": "in_valid & ~rst ? &place[3:2] : in_frame_end",
    "counts": "live & ~reset",
    "map_write": "live",
    "map_write_node map_write_zero": "live & map_write",
}
PROOFS = (
    *(
        Proof(
            "two rows of blocks and a cut one, and a single whole one; rows, columns and frames are only counted; a "
            "beat of a block, and of two",
            {"Sums": 0, "Rows": rows, "Columns": 4 * lanes, "Lanes": lanes},
        )
        for rows, lanes in ((5, 1), (2, 1), (3, 2), (3, 4))
    ),
    Proof(
        f"a cut row of blocks; sums are exact at any width; {ROUNDING}",
        {"Sums": 1, "Rows": 3},
    ),
)


WORDS = 2048  # that a test sends, about


class Capture:
    """Device, and the writes that are expected of it."""

    def __init__(self, dut: Any, gap: float = 0.0, pause: float = 0.0) -> None:
        self.dut = dut
        self.config = Grid.of(dut)
        self.largest, self.lanes = parameters(dut, "MaxLog2", "Lanes")
        block_log2 = self.config.reference_block_log2
        self.side, self.levels = side(self.lanes, block_log2), levels(self.lanes, block_log2)
        self.clocks = cycles(self.lanes, block_log2)
        self.shape = (self.config.rows, self.config.columns)
        self.row = self.config.columns // self.lanes  # beats of a row
        self.size = self.config.rows * self.row
        self.width = self.config.depth.width
        self.bench = Bench(dut, pause)
        self.chance = self.bench.random
        self.driver = DepthDriver(dut, self.bench, gap)
        self.frame: Any = None  # of the frame that is being sent
        self.place = 0  # of the next beat in its frame
        self.under_way: deque[Any] = deque(
            [None] * self.levels
        )  # frame of each beat on its way to the sum, None: no beat
        self.busy = self.inside = False
        # frames since the request, and the number requested
        self.taken: list[Any] = []
        self.count = 0
        self.zero: Any = None  # from the last requested frame on
        # node and zero offset by cycle; cycle of done
        self.writes: dict[Any, Any] = {}
        self.due: Any = None
        self.captures = 0
        dut.request.value, dut.log2_frames.value = 0, 0

    async def start(self) -> None:
        await self.bench.start()
        cocotb.start_soon(self.run())

    def stop(self) -> None:
        self.inside = False
        self.zero = None
        self.writes = {}
        self.due = None

    async def run(self) -> None:
        """Check each cycle against the rules in the header of the core."""
        read, edge = by_name(self.dut), RisingEdge(self.dut.clk)
        for clock in itertools.count():
            await edge
            if read("rst"):
                assert not read("map_write"), "a write in reset"
                self.stop()
                self.busy, self.place = False, 0
                self.under_way = deque([None] * self.levels)
                continue
            done = clock == self.due
            assert read("done") == done, f"done is {read('done')}, {self.due and self.due - clock} clocks off"
            assert read("busy") == self.busy
            write = self.writes.pop(clock, None)
            assert read("map_write") == (write is not None), f"map_write is {read('map_write')}"
            if write is not None:
                assert (read("map_write_node"), read("map_write_zero")) == write
            if done:
                self.stop()
                self.busy = False
                self.captures += 1
            self.under_way.append(self.frame if read("en") and read("in_valid") else None)
            frame = self.under_way.popleft()
            if frame is not None:
                self.take(clock, frame)
            if read("request"):
                self.stop()
                self.busy, self.taken = True, []

    def take(self, clock: Any, frame: Any) -> None:
        """Add a beat, `levels` cycles after it entered."""
        row, beat = divmod(self.place, self.row)
        if self.place == 0:
            self.inside = self.busy and self.zero is None
            if self.inside:
                if not self.taken:
                    self.count = 1 << min(int(self.dut.log2_frames.value), self.largest)
                self.taken.append(frame)
                if len(self.taken) == self.count:
                    self.zero = captured_zero(np.array(self.taken), self.config)
        self.place = (self.place + 1) % self.size
        log2, (rows, columns) = self.config.reference_block_log2, self.config.reference_nodes
        last = (1 << log2) - 1
        node_row, end = row >> log2, (beat + 1) * self.lanes  # the column after the beat
        if not self.inside or self.zero is None or node_row >= rows or row & last != last or end & last:
            return
        behind = node_row * columns + (end >> log2)  # the last node of the beat
        (word,) = packed(self.zero.reshape(-1)[None, behind - self.side : behind], self.width)
        self.writes[clock + self.clocks - self.levels - 1] = (behind // self.side - 1, word)
        if behind == rows * columns:
            self.due = clock + self.clocks - self.levels

    async def send(self, depths: Any = None, count: int | None = None) -> None:
        """Send a frame, or its first words."""
        self.frame = random_depths(self.shape, self.width, self.chance) if depths is None else depths
        await self.driver.words(depth_words(self.frame, self.width, self.lanes)[:count])

    request = request

    async def until_done(self, depths: Any = None) -> None:
        """Send frames until the capture is done and the current frame has ended; then send one that is not cut."""
        before = self.captures
        while self.captures == before:
            await self.send(depths)
            for _ in range(self.chance.choice((0, self.clocks + 2))):
                await RisingEdge(self.dut.clk)


@on_bench(Capture, milliseconds=100)
@parametrize((("gap", "pause"), sample([(0.0, 0.0), (0.0, 0.5), (0.6, 0.0), (0.3, 0.3)])), ("log2", sample([0, 1, 3])))
async def captures(device: Capture, gap: float, log2: int) -> None:
    """Capture frames in a row; earlier frames do not count."""
    await device.send()
    if device.size > WORDS and (log2 > 1 or gap):
        return
    for count in range(1, 5):
        await device.request(log2)
        await device.until_done()
        assert device.captures == count


@cocotb.test(timeout_time=100, timeout_unit="ms")
@parametrize(high=[False, True])
async def most_frames(dut: Any, high: bool) -> None:
    """Ask for more frames than fit the sum, all at one end of the range, while the exponent changes."""
    device = Capture(dut, 0.0, 0.0)
    if device.size << device.largest > 32 * WORDS:
        return
    await device.start()
    depths = np.full(device.shape, (1 << device.width - 1) - 1 if high else -(1 << device.width - 1))
    for log2 in range(device.largest, 16) if device.largest < 4 else (15,):
        await device.request(log2)
        before = device.captures
        await device.send(depths)
        dut.log2_frames.value = 0
        if device.captures == before:  # one frame, cut below its last nodes, is done before it ends
            await device.until_done(depths)
        assert device.captures == before + 1
        assert len(device.taken) == 1 << device.largest


@on_bench(Capture, milliseconds=100)
async def depths_of_all_kinds(device: Capture) -> None:
    """Capture depths at their limits, at ties of either sign, and random ones."""
    for index in range(1 if device.size > WORDS else 30 if REGRESS else 12):
        await device.request(min(index % 4, device.largest))
        await device.until_done()


@on_bench(Capture, milliseconds=200)
@parametrize(pause=[0.0, 0.4])
async def requests_at_any_time(device: Capture) -> None:
    """Request a capture while idle, armed, summing and writing, and in the cycles of a frame's first word, its last
    word and done."""
    size = device.size
    waits = [*range(8), *range(size - 2, size + device.clocks + 4), 2 * size]
    rows = size - size % (device.row << device.config.reference_block_log2)  # beats before a cut row of blocks
    waits += range(rows - 3, rows + device.clocks + 3)
    waits += [device.chance.randrange(size + device.clocks) for _ in range(20)]
    if size > WORDS:
        waits = device.chance.sample(waits, 1)
    elif not REGRESS:
        waits = device.chance.sample(waits, len(waits) // 3)
    await request_after(device, waits, size)


@on_bench(Capture, milliseconds=100)
async def resets(device: Capture) -> None:
    """Reset during a capture: it ends, nothing is written from then on, and the next request is served."""
    size, columns = device.size, device.row
    block = columns << device.config.reference_block_log2  # beats of a row of blocks
    counts = [1, 2, 3, 4, 5, 6, *range(block - columns, block + 8), size - 1, size]
    for turn, count in enumerate(counts if size <= WORDS else []):
        for wait in range(device.clocks + 2) if count == size else (0, 3):
            await device.request(0)
            await device.send(count=count)
            for _ in range(wait):
                await RisingEdge(device.dut.clk)
            await device.bench.reset(en=turn % 2)
            if turn % 3:
                await device.send()
            if turn % 2:
                await device.request(0)
                await device.until_done()
    await device.request(1)
    await device.until_done()
