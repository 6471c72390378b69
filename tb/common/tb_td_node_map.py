# SPDX-License-Identifier: Apache-2.0
"""td_node_map against its model: random and extreme words, rewritten and changed over while frames stream."""

from typing import Any

import cocotb
import numpy as np

from tactile_depth.chip.common.td_node_map import latency, node_map, side
from tb.cases import on_bench
from tb.depth_frames import packed
from tb.nodes import Grid, Nodes, reads_as_a_pause_ends, watch_active
from tb.stream import (
    REGRESS,
    Bench,
    StreamDriver,
    StreamMonitor,
    check_words,
    parameters,
    parametrize,
    places,
    sample,
    send_apart,
)

BEATS = 1024  # that a test sends, at least


class Map:
    """Device, and the words that each frame should get."""

    def __init__(self, dut: Any, gap: float = 0.0, pause: float = 0.0) -> None:
        self.dut, self.gap = dut, gap
        self.config = Grid.of(dut)
        names = ("Lanes", "Channels", "Signed", "Select", "DataWidth")
        self.lanes, channels, self.signed, select, data_width = parameters(dut, *names)
        self.latency = latency(self.lanes, self.config.reference_block_log2)
        self.row = self.config.columns // self.lanes
        self.beats = [(word,) for word in places(self.config.rows * self.row, data_width).tolist()]
        self.frames = max(2, BEATS // len(self.beats))
        self.bench = Bench(dut, pause)
        side_by_side = side(self.lanes, self.config.reference_block_log2)
        self.nodes = Nodes(dut, self.config, select, channels, side_by_side, bool(self.signed))
        self.driver = StreamDriver(dut, "in", "valid", ["data"])
        self.source = StreamMonitor(dut, "in", "valid", ["data"])
        self.sink = StreamMonitor(dut, "out", "valid", ["words", "data"], unsigned=["words"])
        self.expected: list[Any] = []

    async def start(self, written: bool = True) -> None:
        await self.bench.start()
        cocotb.start_soon(watch_active(self.dut, self.latency))
        await self.nodes.settle(written)

    def expect(self, nodes: Any) -> None:
        """Expect a frame with the words of these nodes."""
        if self.signed:
            nodes = nodes - (nodes >> self.nodes.width - 1 << self.nodes.width)
        self.expected.append(node_map(nodes, self.config))

    async def send(self, frames: int = 1) -> None:
        """Send frames back to back, each with the bank at its beginning."""
        for _ in range(frames):
            while self.bench.random.random() < self.gap:
                await self.bench.clocks(1)
            self.expect(self.nodes.begin_frame())
            await self.beats_of_frame(0, 1)
            await self.beats_of_frame(1, None, self.gap)

    async def beats_of_frame(self, begin: int, end: int | None, gap: float = 0.0) -> None:
        await send_apart(self.bench, self.driver, self.beats[begin:end], gap, 0 if begin else len(self.beats))

    async def check(self) -> None:
        await self.bench.clocks(self.latency + 2)
        sent = [beat for _ in self.expected for beat in self.beats]
        assert self.source.words == sent, "the driver sent other words than the test gave it"
        words = np.concatenate([words.reshape(-1, self.lanes * self.nodes.channels) for words in self.expected])
        want = [(word, beat) for word, (beat,) in zip(packed(words, self.nodes.width), sent, strict=True)]
        rows, columns = self.expected[0].shape[:2]
        check_words(np.array(self.sink.words), np.array(want), columns // self.lanes, rows)  # columns are beats
        assert self.sink.starts == [clock + self.latency for clock in self.source.starts]


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def at_power_up(dut: Any) -> None:
    """Read both banks at power-up: they hold the words of the files."""
    device = Map(dut, 0.0, 0.0)
    await device.start(written=False)
    await device.send()
    device.nodes.change()
    await device.send()
    await device.check()


@on_bench(Map, milliseconds=60)
@parametrize((("gap", "pause"), sample([(0.0, 0.0), (0.0, 0.3), (0.3, 0.0), (0.7, 0.5)])))
async def frames_while_the_bus_rewrites(device: Map) -> None:
    """Rewrite nodes while frames stream: the frame before a change-over has the old words, the frame after it the
    new."""
    await device.nodes.write(device.nodes.random(device.bench.random))
    device.nodes.due = True
    going_on = [True]
    rewriter = cocotb.start_soon(device.nodes.rewrite(device.bench.random, lambda: going_on[0]))
    await device.send(device.frames)
    going_on[0] = False
    await rewriter
    await device.check()
    assert len({words.tobytes() for words in device.expected}) > 1, "the test is void: no change-over was seen"


@on_bench(Map, milliseconds=20)
async def read_as_a_pause_ends(device: Map) -> None:
    await reads_as_a_pause_ends(device, device.nodes)
    await device.check()


@on_bench(Map, milliseconds=20)
@parametrize(pause=[0.0, 0.3])
async def named_inside_a_frame(device: Map) -> None:
    """Select the other bank at any beat of a frame: the next frame uses it."""
    stride = device.row + 1 if REGRESS or len(device.beats) < 500 else len(device.beats) // 8
    for count in range(4, len(device.beats), stride):
        await device.nodes.write(device.nodes.random(device.bench.random))
        device.expect(device.nodes.begin_frame())
        await device.beats_of_frame(0, count)
        device.nodes.change()
        await device.beats_of_frame(count, None)
        await device.send()
    await device.check()


@on_bench(Map, milliseconds=20)
async def captured(device: Map) -> None:
    """Capture all nodes, several at once, into both banks; the bus reads the same values, and 0 at unused entries."""
    for _ in range(2):
        await device.nodes.capture(device.nodes.random(device.bench.random))
        for index in range(device.nodes.per_node * device.nodes.banks[0][..., 0].size):
            await device.nodes.read(index)
        device.nodes.due = True
        await device.send()
    await device.check()


@on_bench(Map, milliseconds=20)
async def resets(device: Map) -> None:
    """Reset inside a frame: words and banks stay, a due change-over takes place, and the next frame is right."""
    for count in (1, 2, 3, 4, 6, device.row, 2 * device.row + 3, 5 * device.row // 2):
        await device.nodes.write(device.nodes.random(device.bench.random))
        await device.beats_of_frame(0, count)
        if count % 2:
            device.nodes.change()
        await device.bench.reset(en=count % 4 > 1)
        device.expected.clear()
        device.source.forget()
        device.sink.forget()
        await device.send()
        await device.check()
