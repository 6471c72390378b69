# SPDX-License-Identifier: Apache-2.0
"""Bus and capture of td_node_map and of the cores that contain it: expected content of both banks, change-overs."""

import random
from dataclasses import dataclass
from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge, RisingEdge

from tactile_depth.chip.common.td_node_map import entries_per_node, table_entries
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.fixed_point import Format
from tactile_depth.chip.limits import DARKEST_LOG2
from tb.pins import Driver, by_name
from tb.stream import parameters, places
from tb.table_bus import READ_CLOCKS, TO_TABLE, TableBus

PAUSED = 4  # cycles of a pause before its last one


def first_words(rows: int, columns: int, channels: int, width: int) -> Any:
    """Return the words at power-up, (node rows, node columns, channels); every word differs."""
    return places(rows * columns * channels, width).reshape(rows, columns, channels) & (1 << width) - 1


def random_words(config: Configuration, chance: random.Random, channels: int, width: int) -> Any:
    """Return random words of the nodes: full range, the limits, or like the gains of a sensor."""
    generator = np.random.default_rng(chance.getrandbits(32))
    shape = (*config.reference_nodes, channels)
    largest = (1 << width) - 1
    match chance.randrange(4):
        case 0:
            return generator.integers(0, largest, shape, endpoint=True)
        case 1:
            return generator.choice([0, 1, largest - 1, largest], shape)
        case 2:
            return generator.choice([0, largest], shape)
    return generator.integers(largest >> 5, largest >> 2, shape, endpoint=True)


@dataclass(frozen=True)
class Grid:
    """Grid smaller than a configuration allows, with the fields that the models read."""

    rows: int
    columns: int
    reference_block_log2: int
    depth: Format  # of the words of the nodes

    @classmethod
    def of(cls, dut: Any, width: Any = "Width") -> Any:
        rows, columns, block_log2, width = parameters(dut, "Rows", "Columns", "BlockLog2", width)
        return cls(rows, columns, block_log2, Format(width, 0))

    @property
    def reference_nodes(self) -> tuple[Any, ...]:
        return self.rows >> self.reference_block_log2, self.columns >> self.reference_block_log2

    @property
    def gain(self) -> Format:
        return Format(self.depth.width, self.depth.width + DARKEST_LOG2)


class Nodes:
    """Pins of the bus and of the capture; `banks` holds the expected words, (node rows, node columns, channels), of
    each bank."""

    capture_pin, read_pin = "capture_words", "capture_read_words"

    def __init__(
        self, dut: Any, config: Configuration, select: int, channels: int = 1, side: int = 1, signed: bool = False
    ) -> None:
        self.dut, self.config = dut, config
        self.drive, self.pin, self.edge = Driver(dut), by_name(dut), RisingEdge(dut.clk)
        self.width = config.depth.width
        self.channels, self.side = channels, side  # side: nodes that the capture writes at once
        self.per_node = entries_per_node(channels)
        self.bus = TableBus(dut, select, self.width, signed=signed)
        self.banks = [self.at_power_up(), self.at_power_up()]
        self.bank = 0  # value of table_bank
        self.due = False  # True: the next frame changes the bank
        self.reads_captured = hasattr(dut, "capture_read")
        self.drive(table_bank=0, capture_write=0)
        if self.reads_captured:
            self.drive(capture_read=0)

    def at_power_up(self) -> Any:
        return first_words(*self.config.reference_nodes, self.channels, self.width)

    def random(self, chance: random.Random) -> Any:
        return random_words(self.config, chance, self.channels, self.width)

    async def settle(self, written: bool) -> None:
        """Write the words of power-up into both banks if an earlier test has `written` others, and always on Verilator.

        Verilator starts with random pins, so its first edge may write a word. Icarus, which starts with X, and the top
        test the content at power-up.
        """
        if written or cocotb.SIM_NAME.lower().startswith("verilator"):
            for _ in range(2):
                await self.write(self.at_power_up())
                self.change()
                self.dut.rst.value = 1
                await RisingEdge(self.dut.clk)
                self.dut.rst.value = 0
                await RisingEdge(self.dut.clk)

    def begin_frame(self) -> Any:
        """Change the bank if it is due, as the head of the pipeline does at the first pixel; return the words of that
        frame."""
        if self.due:
            self.change()
        return self.banks[self.bank]

    def change(self) -> None:
        """Select the other bank from the next frame on, or in reset."""
        self.due = False
        self.bank ^= 1
        self.drive(table_bank=self.bank)

    async def changed(self) -> None:
        while self.pin("table_in_use") != self.bank:
            await self.edge

    async def capture(self, words: np.ndarray) -> None:
        """Write all nodes of the free bank as reference_capture writes them, and read each a few cycles later."""
        await self.changed()
        mask = (1 << self.width) - 1
        nodes = words.reshape(-1, self.side * self.channels).tolist()
        written = [sum((word & mask) << self.width * c for c, word in enumerate(node)) for node in nodes]
        for clock in range(len(written) + 3):
            writes, reads = clock < len(written), 0 <= clock - 2 < len(written)
            self.drive(capture_write=writes, capture_write_node=clock if writes else 0)
            self.drive(**{self.capture_pin: written[clock] if writes else 0})
            if self.reads_captured:
                self.drive(capture_read=reads, capture_read_node=clock - 2 if reads else 0)
            await self.edge
            if self.reads_captured and clock >= 3:
                assert self.pin(self.read_pin) == written[clock - 3], f"node {clock - 3} as it is read"
        self.banks[self.bank ^ 1] = words.copy()

    async def write(self, words: Any) -> None:
        """Write all entries of the free bank in order, one per cycle, the unused ones too."""
        await self.changed()
        for index, word in table_entries(words).items():
            await self.write_entry(index, word)
            if index % self.per_node == self.channels - 1:
                for unused in range(index + 1, index + 1 + self.per_node - self.channels):
                    await self.write_entry(unused, (1 << self.width) - 1)
        await RisingEdge(self.dut.clk)  # the last one reaches the table
        assert np.array_equal(self.banks[self.bank ^ 1], words)

    async def rewrite(self, chance: Any, going_on: Any) -> None:
        """Rewrite the free bank repeatedly, commit it when it is complete, and read entries meanwhile."""
        size = self.per_node * self.banks[0][..., 0].size
        while going_on():
            if self.due or self.pin("table_in_use") != self.bank:
                await self.read(chance.randrange(size))
                continue
            await chance.choice((self.write, self.capture))(self.random(chance))
            for _ in range(4):
                await self.read(chance.randrange(size))
            self.due = True

    async def write_entry(self, index: int, word: Any) -> None:
        node, channel = divmod(index, self.per_node)
        if channel < self.channels:
            self.banks[self.bank ^ 1].reshape(-1, self.channels)[node, channel] = word
        await self.bus.write(index, word)

    async def read(self, index: int) -> None:
        """Read and compare an entry of the free bank; a change-over may come in the same cycle."""
        await self.bus.ask(index, (index ^ 5) % (self.per_node * self.banks[0][..., 0].size))
        for _ in range(TO_TABLE + 1):
            await self.edge
        free = 1 - self.pin("table_in_use")  # as it was after the edge of the read
        for _ in range(READ_CLOCKS - TO_TABLE - 1):
            await self.edge
        node, channel = divmod(index, self.per_node)
        want = self.banks[free].reshape(-1, self.channels)[node, channel] if channel < self.channels else 0
        self.bus.check(index, want)
        self.bus.idle()


async def reads_as_a_pause_ends(device: Any, nodes: Nodes) -> None:
    """Pause as the first pixel of a frame waits for its new bank, and read the last node in the pause or as it ends.

    `device` is that of a testbench, with its `bench`."""
    bench, clk = device.bench, device.dut.clk
    rows, columns, channels = nodes.banks[0].shape
    for early in range(PAUSED + 1):
        await nodes.write(np.roll(first_words(rows, columns, channels, nodes.width), early))
        nodes.due = True
        sending = cocotb.start_soon(device.send())
        await FallingEdge(clk)
        bench.pause = 1.0  # from the next edge on, at which the pixel is taken
        for _ in range(early):
            await RisingEdge(clk)
        reading = cocotb.start_soon(nodes.read(nodes.per_node * (rows * columns - 1)))
        for _ in range(PAUSED + 1 - early):
            await RisingEdge(clk)
        bench.pause = 0.0
        await reading
        await sending
        await nodes.changed()
