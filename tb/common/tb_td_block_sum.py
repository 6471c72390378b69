# SPDX-License-Identifier: Apache-2.0
"""td_block_sum against its model, with a memory: every write in its cycle, sums over frames, gaps, resets."""

import itertools
import random
from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import RisingEdge

from formal.entries import Proof
from tactile_depth.chip.common.td_block_sum import CYCLES_TO_SUM, block_sum
from tb.pins import Driver, by_name
from tb.stream import MANY, parameters, parametrize, start_clock
from tb.structures import ICARUS, VERILATOR, Structure


def built(*case: int, **runs: Any) -> Structure:
    names = ("Rows", "Columns", "BlockLog2", "ColumnLog2", "Channels", "Width", "Signed", "SumWidth")
    return Structure(dict(zip(names, case, strict=True)), **runs)


STRUCTURES = (
    built(21, 16, 2, 2, 1, 24, 1, 38, on=VERILATOR),
    built(5, 8, 1, 1, 3, 8, 0, 11, on=ICARUS, mutants=ICARUS),
    built(5, 4, 1, 1, 1, 4, 1, 8, on=ICARUS),
    built(7, 4, 1, 0, 2, 5, 1, 10, on=ICARUS, mutants=ICARUS),
    built(8, 16, 1, 1, 3, 8, 0, 24),
    built(16, 16, 3, 3, 1, 12, 1, 24),
    built(21, 16, 3, 1, 1, 24, 1, 38),
)
REFUSED = {
    "BlockLog2_must_be_at_least_1": "BlockLog2=0",
    "Columns_must_be_a_power_of_two": "Columns=96",
    "two_blocks_a_row_and_one_a_column_are_needed": "Columns=8, Rows=7",
    "SumWidth_must_be_more_than_Width_plus_ColumnLog2": "SumWidth=27",
}
PROOFS = tuple(
    Proof(
        "a cut row of blocks; rows, columns and frames are only counted; sums are exact at any width",
        {"Signed": signed, "ColumnLog2": column_log2},
    )
    for signed, column_log2 in ((0, 1), (1, 1), (1, 0))
)


NAMES = ("Rows", "Columns", "BlockLog2", "ColumnLog2", "Channels", "Width", "Signed", "SumWidth")


class Device:
    """Core, a memory that refuses accesses with an undefined result in td_ram.sv, and the expected writes."""

    def __init__(self, dut: Any, gap: float = 0.0) -> None:
        self.dut, self.gap = dut, gap
        self.pins, self.read, self.clk_edge = Driver(dut), by_name(dut), RisingEdge(dut.clk)
        self.rows, self.columns, self.log2, self.column_log2, *more = parameters(dut, *NAMES)
        self.channels, self.width, self.signed, self.sum_width = more
        self.blocks = (self.rows >> self.log2, self.columns >> self.column_log2)
        self.chance = random.Random(cocotb.RANDOM_SEED)
        self.generator = np.random.default_rng(cocotb.RANDOM_SEED)
        self.memory: dict[int, int] = {}
        self.due: dict[int, tuple[int, int, bool]] = {}  # block, word, complete, by cycle
        self.sums = np.zeros((*self.blocks, self.channels), np.int64)
        self.clock = 0
        self.writes = 0

    async def start(self) -> None:
        self.drive(False, 0)
        self.dut.rst.value = 1
        start_clock(self.dut.clk)
        await RisingEdge(self.dut.clk)
        await RisingEdge(self.dut.clk)
        self.dut.rst.value = 0

    def drive(self, valid: bool, data: int, start: int = 0, first: int = 0, last: int = 0) -> None:
        self.pins(in_valid=valid, in_data=data, in_frame_start=start, in_first_frame=first, in_last_frame=last)

    def packed(self, words: list[int], width: int) -> int:
        return sum((word & (1 << width) - 1) << width * channel for channel, word in enumerate(words))

    async def edge(self) -> None:
        """Run one cycle of the memory and of the checks."""
        read = self.read
        await self.clk_edge
        self.clock += 1
        expected = self.due.pop(self.clock, None)
        assert read("write_en") == (expected is not None), f"write_en in clock {self.clock}"
        assert read("write_complete") == (expected is not None and expected[2]), "write_complete"
        reads = read("read_en")
        if reads:
            address = read("read_block")
            assert address in self.memory, f"block {address} is read before it was written"
        if expected is not None:
            self.writes += 1
            block, word, _ = expected
            assert (read("write_block"), read("write_sums")) == (block, word), f"in clock {self.clock}"
            assert not reads or address != block, f"block {block} is read while it is written"
            self.memory[block] = word
        word = self.memory[address] if reads else self.chance.getrandbits(self.channels * self.sum_width)
        self.pins(read_sums=word)

    async def idle(self, clocks: int = 1) -> None:
        for _ in range(clocks):
            coin = self.chance.getrandbits
            self.drive(False, coin(self.channels * self.width), coin(1), coin(1), coin(1))
            await self.edge()

    def frame_words(self) -> np.ndarray:
        """Return random words, or words at the limits."""
        low, high = (-(1 << self.width - 1), (1 << self.width - 1) - 1) if self.signed else (0, (1 << self.width) - 1)
        shape = (self.rows, self.columns, self.channels)
        match self.chance.randrange(4):
            case 0:
                return np.full(shape, self.chance.choice((low, high)))
            case 1:
                return self.generator.choice([low, high], shape)
        return self.generator.integers(low, high, shape, endpoint=True)

    async def frame(self, first: bool, last: bool, count: int | None = None) -> None:
        """Send a frame, or its first words; sums add up."""
        words = self.frame_words()
        totals = block_sum(words[None, ...], self.log2, self.column_log2)[0]
        before = np.zeros_like(self.sums) if first else self.sums
        rows, columns = self.blocks
        size, wide = 1 << self.log2, 1 << self.column_log2
        for place, word in enumerate(words.reshape(-1, self.channels)[:count].tolist()):
            while self.chance.random() < self.gap:
                await self.idle()
            marks = (int(first), int(last)) if place == 0 else (self.chance.getrandbits(1), self.chance.getrandbits(1))
            self.drive(True, self.packed(word, self.width), int(place == 0), *marks)
            await self.edge()
            row, column = divmod(place, self.columns)
            if column % wide == wide - 1 and row < rows * size:
                so_far = words[row // size * size : row + 1, column - wide + 1 : column + 1].sum(axis=(0, 1))
                at = row // size, column // wide
                total = self.packed((before[at] + so_far).tolist(), self.sum_width)
                complete = last and row % size == size - 1
                self.due[self.clock + CYCLES_TO_SUM] = at[0] * columns + at[1], total, complete
        self.sums = before + totals

    async def reset(self) -> None:
        self.drive(False, 0)
        self.dut.rst.value = 1
        await self.edge()
        self.dut.rst.value = 0
        self.due.clear()


@cocotb.test()
@parametrize(gap=[0.0, 0.3])
async def sums(dut: Any, gap: float) -> None:
    """Capture one frame and several, one capture after another, and send frames after the last one."""
    device = Device(dut, gap)
    await device.start()
    for frames in (1, 1, 2, 5) * MANY:
        for index in range(frames):
            await device.frame(index == 0, index == frames - 1)
        for _ in range(device.chance.randrange(2)):
            await device.frame(False, False)
        await device.idle(device.chance.choice([0, CYCLES_TO_SUM + 1]))
    await device.idle(CYCLES_TO_SUM + 1)
    assert not device.due
    assert device.writes > 9 * MANY * np.prod(device.blocks)


@cocotb.test()
async def resets(dut: Any) -> None:
    """Reset in any cycle of a frame and after it: nothing of the frame is written."""
    device = Device(dut)
    await device.start()
    await device.frame(True, True)
    size = device.rows * device.columns
    counts = range(1, size + 1) if size <= 64 else [*range(1, 8), *range(size - 7, size + 1)]
    for count, wait in itertools.product(counts, range(CYCLES_TO_SUM + 1)):
        await device.frame(True, True, count)
        await device.idle(wait)
        await device.reset()
        await device.idle(device.chance.choice([0, CYCLES_TO_SUM + 1]))
        if count % 4 == 0:
            await device.frame(True, False)
    await device.idle(CYCLES_TO_SUM + 1)
    assert not device.due
