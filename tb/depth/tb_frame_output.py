# SPDX-License-Identifier: Apache-2.0
"""frame_output against tactile_depth.chip.depth.frame_output: words, side-bands and marks in every enabled cycle."""

import random
from typing import Any

import cocotb
from cocotb.triggers import RisingEdge

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.depth.frame_output import Clock, frame_output
from tb.cases import on_bench
from tb.pins import Driver, by_name
from tb.stream import depth_position, parameters, parametrize, start_clock
from tb.structures import BOTH, ICARUS, Structure

STRUCTURES = (
    Structure({"Width": 24, "Rows": 4, "Columns": 8}, on=BOTH),
    Structure({"Width": 12, "Rows": 16, "Columns": 2}, on=BOTH, mutants=ICARUS),
)
PROTOCOL = {"counts": "live & ~reset & en", "out_data": "counts & out_valid"}
PROOFS = (
    Proof(
        f"rows and columns are only counted; {WORD_FREE}",
        {"Rows": 3, "Columns": 4},
    ),
)


class Bench:
    """Driver of one cycle at a time; it keeps the outputs and compares them with the model at the end."""

    def __init__(self, dut: Any, pause: float = 0.0) -> None:
        self.dut, self.pause = dut, pause
        self.drive, self.read = Driver(dut), by_name(dut)
        self.random = random.Random(cocotb.RANDOM_SEED)
        self.width, self.rows, self.columns = parameters(dut, "Width", "Rows", "Columns")

    async def start(self) -> None:
        start_clock(self.dut.clk)
        self.drive(en=1)
        await self.reset()

    async def reset(self) -> None:
        self.drive(in_start=0, in_frame_start=0, in_due=0, rst=1)
        await RisingEdge(self.dut.clk)
        self.drive(rst=0)
        self.left = 0  # words of the frame, the current one included
        self.inputs: list[Any] = []
        self.beats: list[Any] = []
        self.clocks: list[Any] = []
        self.ends: list[Any] = []
        self.out_of_step: list[Any] = []

    async def clock(
        self, start: bool = False, frame_start: bool = False, due: bool = False, bad: bool | None = None
    ) -> None:
        """Run one cycle. in_bad has its value with in_due only, and is random elsewhere."""
        read, coin, edge = self.read, self.random.random, RisingEdge(self.dut.clk)
        bad = coin() < 0.5 if bad is None else bad
        word = Clock(start, frame_start, self.random.getrandbits(self.width), due, bad)
        self.drive(in_start=start, in_frame_start=frame_start, in_data=word.data, in_due=due, in_bad=bad)
        en = False
        while not en:
            en = coin() >= self.pause
            self.drive(en=en)
            await edge
        now = len(self.inputs)
        self.inputs.append(word)
        position = read("out_position")
        self.left = self.rows * self.columns if due else max(self.left - 1, 0)
        row_end, frame_end = bool(self.left) and self.left % self.columns == 1 % self.columns, self.left == 1
        assert position == depth_position(due, row_end, frame_end), f"position {position:03b}, {self.left} words left"
        if read("out_valid"):
            self.beats.append((read("out_data"), position >> 1 & 1, position >> 2))
            self.clocks.append(now)
            assert read("active")
        if position & 1:
            self.ends.append(now)
        if read("out_of_step"):
            self.out_of_step.append(now)

    async def frame(self, bad: bool = False, rows: int | None = None, due: bool = True, begins: bool = True) -> None:
        for row in range(self.rows if rows is None else rows):
            for column in range(self.columns):
                first = row == column == 0
                await self.clock(column == 0, first and begins, first and due, bad if first else None)

    async def idle(self, clocks: int) -> None:
        for _ in range(clocks):
            await self.clock()

    def check(self) -> Any:
        want = frame_output(self.inputs, self.rows, self.columns)
        assert self.out_of_step == want.out_of_step
        assert self.beats == want.beats
        assert self.clocks == want.clocks
        assert self.ends == want.ends
        return want


@on_bench(Bench)
@parametrize(gap=[0, 7], pause=[0.0, 0.4])
async def frames(bench: Bench, gap: int) -> None:
    """Send frames: those marked bad do not leave, the others do, and out_of_step stays low."""
    marks = [0, 1, 0, 0, 1, 1, 0, *(bench.random.randint(0, 1) for _ in range(6))]
    for bad in marks:
        await bench.idle(bench.random.randint(0, gap))
        await bench.frame(bool(bad))
    await bench.idle(2)
    out = bench.check()
    assert not out.out_of_step
    assert len(out.beats) == marks.count(0) * bench.rows * bench.columns
    assert len(out.ends) == len(marks)


@on_bench(Bench)
async def out_of_step(bench: Bench) -> None:
    """Send a frame that is not due, omit one that is due, send rows too early, too late or without a start."""
    await bench.frame(due=False)
    await bench.frame()
    await bench.frame(begins=False)
    await bench.frame(rows=1)
    await bench.idle(bench.rows * bench.columns - bench.columns)
    await bench.frame()
    await bench.clock(start=True)
    await bench.clock(frame_start=True)
    await bench.clock(due=True, bad=False)
    await bench.idle(3)
    await bench.frame()
    good = bench.check()
    assert len(good.out_of_step) > 5


@on_bench(Bench, pause=0.1)
async def whatever_comes(bench: Bench) -> None:
    """Drive each input at random: frames that leave have the right form for any bursts."""
    chance = bench.random.random
    for _ in range(2000):
        await bench.clock(chance() < 0.2, chance() < 0.1, chance() < 0.05)
    bench.check()


@on_bench(Bench)
@parametrize(bad=[False, True])
async def resets(bench: Bench, bad: Any) -> None:
    """Reset in any row of a frame: nothing of the frame leaves afterwards."""
    for row in range(1, bench.rows + 1):
        await bench.frame(bad, rows=row)
        await bench.reset()
        await bench.idle(bench.columns + 1)
        bench.check()
        assert not bench.beats, f"words left after a reset in row {row}"
        await bench.frame()
        bench.check()
        await bench.reset()
