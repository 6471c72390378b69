# SPDX-License-Identifier: Apache-2.0
"""zero_offset against its model in every cycle: depths and nodes of all kinds, changed over while frames stream."""

import random
from collections import deque
from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge, RisingEdge

from formal.entries import ROUNDING, Proof
from formal.tables import zero_rom
from tactile_depth.chip.common import td_node_map
from tactile_depth.chip.common.td_node_map import node_map, side
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.depth.zero_offset import latency as zero_offset_latency
from tactile_depth.chip.depth.zero_offset import zero_offset
from tactile_depth.chip.registers.register_map import TABLES
from tactile_depth.chip.rom_files import write_zero
from tb.cases import on_bench
from tb.depth_frames import DepthDriver, depth_words, packed, random_depths
from tb.nodes import Grid, Nodes
from tb.pins import by_name
from tb.stream import Bench, depth_position, parameters, parametrize, places, sample
from tb.structures import ICARUS, VERILATOR, Structure


def built(columns: int, rows: int, block_log2: int, width: int, lanes: int, **runs: Any) -> Structure:
    zero = places((rows >> block_log2) * (columns >> block_log2), width)  # that of the testbench
    return Structure(
        {"Rows": rows, "Columns": columns, "BlockLog2": block_log2, "Width": width, "Lanes": lanes},
        roms=lambda folder: write_zero(folder, zero, width, side(lanes, block_log2)),
        **runs,
    )


STRUCTURES = (
    built(16, 15, 2, 4, 1, on=VERILATOR, mutants=ICARUS),
    built(32, 15, 2, 8, 4, on=VERILATOR),
    built(
        16,
        8,
        1,
        24,
        1,
        on=ICARUS,
    ),
    built(4, 2, 1, 5, 1, on=ICARUS),
    built(16, 11, 2, 6, 2, on=ICARUS, mutants=ICARUS),
    built(16, 16, 1, 12, 1),
    built(32, 21, 1, 16, 1),
    built(128, 8, 3, 32, 1),
    built(64, 64, 2, 24, 1),
    built(16, 16, 1, 12, 4),
    built(128, 21, 3, 24, 8),
    built(256, 8, 3, 32, 32),
    built(128, 21, 3, 24, 32),
    built(128, 21, 3, 24, 64),
    built(16, 9, 1, 12, 8, on=ICARUS),
    built(64, 35, 5, 16, 4),
)
PROTOCOL = {
    "protocol_node_map": {
        "Select": "td_register_map_pkg::TableSelectZero",
        "in_frame_start": "in_position[2]",
        "capture_read": "1'b0",
        "capture_read_node": "'0",
    },
    "in_position": "in_valid & ~rst ? {&place[1:0], place[3], &place[3:2]} : in_position",
    "out_position": "counts_out_data",
    "saturations": "live & ~reset",
}
PROOFS = tuple(
    Proof(
        f"subtraction is exact at any width; {ROUNDING}; td_node_map is proven by itself",
        {"Rows": 2, "Lanes": lanes, "Latency": zero_offset_latency(lanes, 1)},
        roms=zero_rom,
        free=("zero_words",),
    )
    for lanes in (1, 2)
)


WORDS = 2048  # that a test sends, at least


def first_zero(config: Configuration) -> Any:
    """Return the zero offset of zero_0.hex, (node rows, node columns); every node differs."""
    rows, columns = config.reference_nodes
    return places(rows * columns, config.depth.width).reshape(rows, columns)


class Zeros(Nodes):
    """Memory of the zero offset."""

    capture_pin = "capture_zero"

    def at_power_up(self) -> Any:
        return first_zero(self.config)[..., None]

    def random(self, chance: random.Random) -> Any:
        return random_depths((*self.config.reference_nodes, 1), self.width, chance)


class Zero:
    """Device, and the words that the model expects for every word sent."""

    def __init__(self, dut: Any, gap: float = 0.0, pause: float = 0.0) -> None:
        self.dut, self.gap = dut, gap
        self.config = Grid.of(dut)
        self.shape = (self.config.rows, self.config.columns)
        self.width = self.config.depth.width
        self.frames = max(3, WORDS // (self.config.rows * self.config.columns))
        self.large = self.config.rows * self.config.columns > WORDS  # so that a large grid gets a few frames only
        self.bench = Bench(dut, pause)
        self.chance = self.bench.random
        (self.lanes,) = parameters(dut, "Lanes")
        self.latency = zero_offset_latency(self.lanes, self.config.reference_block_log2)
        side = td_node_map.side(self.lanes, self.config.reference_block_log2)
        self.zeros = Zeros(dut, self.config, TABLES["zero"], side=side, signed=True)
        self.driver = DepthDriver(dut, self.bench, gap)
        self.monitor = Monitor()
        self.counted = 0  # of `saturations`
        self.forget()

    def forget(self) -> None:
        """Forget the words sent and the words expected."""
        self.sent: list[Any] = []
        self.taken = 0
        self.expected: list[Any] = []  # of each beat: data, values clipped
        self.used: list[Any] = []
        self.inside: deque[int | None] = deque([None] * self.latency)
        self.begun = False
        self.clipped = 0

    async def start(self, written: bool = True) -> None:
        await self.bench.start()
        await self.zeros.settle(written)
        cocotb.start_soon(self.watch())

    async def watch(self) -> None:
        """Check each cycle: a beat leaves `latency` enabled cycles after it entered, and its clips are counted as it
        leaves."""
        read, edge = by_name(self.dut), RisingEdge(self.dut.clk)
        while True:
            await edge
            if read("rst"):
                continue
            active = self.begun or any(index is not None and self.sent[index][2] for index in self.inside)
            assert read("active") == active, f"active is {read('active')}"
            assert read("saturations") == self.clipped, f"saturations is {read('saturations')}"
            self.counted += self.clipped
            self.clipped = 0
            if not read("en"):
                continue
            leaves = self.inside.pop()
            assert read("out_valid") == (leaves is not None), f"out_valid is {read('out_valid')}"
            if leaves is not None:
                position, got = read("out_position"), read("out_data")
                assert position == depth_position(*self.sent[leaves][:3]), f"beat {leaves}: position {position:03b}"
                assert got == self.expected[leaves][0], f"beat {leaves}: {got:#x}, not {self.expected[leaves][0]:#x}"
            comes = None
            if read("in_valid"):
                comes, self.taken = self.taken, self.taken + 1
                *marks, data = self.sent[comes]
                pins = read("in_position"), read("in_data")
                assert pins == (depth_position(*marks), data), "the driver sent other words than the test gave it"
                self.begun = not marks[2]
            self.inside.appendleft(comes)
            self.clipped = 0 if self.inside[-1] is None else self.expected[self.inside[-1]][1]

    def depths(self, zero: np.ndarray | None = None) -> Any:
        """Return a frame. With a zero offset some depths equal it, some differences lie at the limits or beyond."""
        if zero is None or self.chance.random() < 0.6:
            return random_depths(self.shape, self.width, self.chance)
        low, high = -(1 << self.width - 1), (1 << self.width - 1) - 1
        generator = np.random.default_rng(self.chance.getrandbits(32))
        target = generator.choice([low - 1, low, low + 1, -1, 0, 1, high - 1, high, high + 1], self.shape)
        return np.clip(node_map(zero, self.config) + target, low, high)

    async def send(self, frames: int = 1, depths: np.ndarray | None = None, count: int | None = None) -> None:
        """Send frames back to back, or the first words of one. Each uses the bank that table_bank then selects."""
        for _ in range(frames):
            zero = self.zeros.begin_frame()[..., 0].copy()
            frame = self.depths(zero) if depths is None else depths
            words = depth_words(frame, self.width, self.lanes)[:count]
            self.sent += words
            self.used.append(zero.tobytes())
            zeroed = zero_offset(frame, zero, self.config, self.monitor)
            clipped = (frame - node_map(zero, self.config) != zeroed).reshape(-1, self.lanes).sum(axis=1)
            self.expected += zip(packed(zeroed.reshape(-1, self.lanes), self.width), clipped.tolist(), strict=True)
            await self.driver.words(words)

    async def reset(self, en: Any) -> None:
        resetting = cocotb.start_soon(self.bench.reset(en))
        await FallingEdge(self.dut.clk)  # after the tasks of the previous cycle
        self.forget()
        await resetting

    async def check(self) -> None:
        """Wait until everything has left, and compare."""
        await self.bench.clocks(self.latency + 3)
        assert self.taken == len(self.sent) == len(self.expected)
        assert not any(index is not None for index in self.inside)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def at_power_up(dut: Any) -> None:
    """Subtract the zero offset of zero_0.hex, which both banks hold at power-up."""
    device = Zero(dut, 0.0, 0.0)
    await device.start(written=False)
    for _ in range(2):
        await device.send()
        await device.check()
        assert device.used[-1] == first_zero(device.config).tobytes()
        device.zeros.due = True


@on_bench(Zero, milliseconds=60)
@parametrize((("gap", "pause"), sample([(0.0, 0.0), (0.0, 0.3), (0.3, 0.0), (0.7, 0.5)])))
async def frames_while_the_bus_rewrites(device: Zero) -> None:
    """Rewrite the zero offset while frames stream: the frame before a change-over has the old one, the frame after it
    the new."""
    await device.zeros.write(device.zeros.random(device.chance))
    device.zeros.due = True
    going_on = [True]
    rewriter = cocotb.start_soon(device.zeros.rewrite(device.chance, lambda: going_on[0]))
    await device.send(device.frames)
    going_on[0] = False
    await rewriter
    await device.check()
    assert len(set(device.used)) > 1, "the test is void: no change-over was seen"
    assert device.counted == device.monitor.saturations.total() > 0


@on_bench(Zero, milliseconds=20)
async def captured(device: Zero) -> None:
    """Capture all nodes into both banks; the bus reads the same values."""
    for _ in range(2):
        await device.zeros.capture(device.zeros.random(device.chance))
        for index in range(device.zeros.banks[0].size):
            await device.zeros.read(index)
        device.zeros.due = True
        await device.send()
    await device.check()


@on_bench(Zero, milliseconds=60)
async def differences_at_their_limits(device: Zero) -> None:
    """Reach differences that just fit, differences that are just clipped, and the largest difference of all."""
    low, high = -(1 << device.width - 1), (1 << device.width - 1) - 1
    for level in (low,) if device.large else (low, low + 1, -1, 0, 1, high - 1, high):
        await device.zeros.write(np.full((*device.config.reference_nodes, 1), level))
        device.zeros.due = True
        await device.send()  # its first word changes the bank
        await device.zeros.changed()
        for depth in (low + level, low + level - 1, high + level, high + level + 1, low, high):
            if low <= depth <= high:
                await device.send(depths=np.full(device.shape, depth))
    await device.check()
    assert device.counted == device.monitor.saturations.total() > 0


@on_bench(Zero, milliseconds=20)
async def resets(device: Zero) -> None:
    """Reset inside a frame: no earlier word leaves or is counted, the nodes stay, and a due change-over takes place."""
    row = device.config.columns // device.lanes
    size = device.config.rows * row
    counts = (1, 2, 3, 4, *range(device.latency - 2, device.latency + 3), 2 * row + 3, size)
    for turn, count in enumerate(counts[-2:] if device.large else counts):
        await device.zeros.write(device.zeros.random(device.chance))
        await device.send(count=count)
        if count % 2:
            device.zeros.change()
        await device.reset(en=turn % 2)
        if count % 3:
            await device.bench.clocks(device.latency + 2)
        await device.send()
        await device.check()
