# SPDX-License-Identifier: Apache-2.0
"""td_node_map against its model: random and extreme words, rewritten and changed over while frames stream."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import Proof
from formal.tables import node_rom
from tactile_depth.chip.common.td_node_map import latency, node_map, side
from tactile_depth.chip.rom_files import write_nodes
from tb.cases import on_bench
from tb.depth_frames import packed
from tb.nodes import Grid, Nodes, first_words, reads_as_a_pause_ends, watch_active
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
from tb.structures import ICARUS, VERILATOR, Structure


def built(
    columns: int, rows: int, block_log2: int, width: int, channels: int, lanes: int, signed: int, **runs: Any
) -> Structure:
    nodes = first_words(rows >> block_log2, columns >> block_log2, channels, width)
    shape = {"Rows": rows, "Columns": columns, "BlockLog2": block_log2, "Width": width}
    return Structure(
        shape | {"Channels": channels, "Lanes": lanes, "Signed": signed, "Select": rows % 4},
        roms=lambda folder: write_nodes(folder, "nodes", nodes, width, side(lanes, block_log2)),
        **runs,
    )


# A beat of half a block, of a quarter, of a whole one, of several; rows of blocks that the frame cuts above their
# middle, and below; one pixel, with three words.
STRUCTURES = (
    built(32, 19, 2, 12, 1, 4, 1, on=VERILATOR),
    built(16, 11, 2, 4, 3, 1, 0, on=VERILATOR, mutants=ICARUS),
    built(16, 11, 2, 4, 1, 2, 0, on=ICARUS, mutants=ICARUS),
    built(16, 13, 3, 5, 1, 2, 1, on=ICARUS),
    built(16, 3, 1, 3, 1, 4, 1, on=ICARUS, mutants=ICARUS),
    built(4, 2, 1, 5, 1, 1, 0, on=ICARUS),
    built(4, 3, 1, 1, 2, 1, 0, on=ICARUS),
    built(16, 5, 1, 3, 2, 4, 0, on=ICARUS),
    built(128, 24, 3, 24, 1, 8, 1),
    built(128, 21, 3, 24, 1, 16, 1),
    built(256, 8, 3, 24, 1, 32, 1),
    built(128, 21, 3, 24, 1, 32, 1),
    built(64, 64, 2, 24, 1, 2, 1),
    built(128, 40, 4, 18, 1, 2, 1),
    built(32, 11, 1, 8, 1, 2, 1),
    built(16, 8, 1, 24, 3, 1, 0),
    built(32, 21, 2, 24, 3, 1, 0),
    built(128, 8, 3, 24, 3, 1, 0),
    built(64, 64, 2, 24, 3, 1, 0),
)
REFUSED = {
    "blocks_of_2_pixels_or_more_two_beats_and_two_blocks_a_row_and_one_block_a_column_are_needed": "BlockLog2=0, "
    "Columns=8, Rows=7, Lanes=128",
    "Columns_and_Lanes_must_be_powers_of_two_with_Lanes_of_two_blocks_Channels_too": "Columns=96, Lanes=3, "
    "Lanes=16 Channels=3",
}
PROTOCOL = "protocol_node_map"
PROOFS = tuple(
    Proof(
        "half a block to a beat, a whole one, two; a cut row of blocks; weights and sums are exact at any width",
        {
            "Along": along,
            "Rows": (2 << block_log2) + 1,
            "Columns": columns,
            "BlockLog2": block_log2,
            "Channels": channels,
            "Lanes": lanes,
            "Signed": signed,
            "Latency": latency(lanes, block_log2),
        },
        roms=node_rom("nodes", 2 * (columns >> block_log2), channels, side(lanes, block_log2)),
        free=("sums",) if along else (),
    )
    for along in (0, 1)
    for columns, block_log2, channels, lanes, signed in (
        (8, 2, 1, 2, 1),
        (4, 1, 1, 2, 1),
        (8, 1, 1, 4, 1),
        (4, 1, 3, 1, 0),
        (4, 1, 1, 1, 1),
    )
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
