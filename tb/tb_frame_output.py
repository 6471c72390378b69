# SPDX-License-Identifier: Apache-2.0
"""frame_output against models.frame_output: what leaves, side-bands, frame_start and frame_end."""

import os

import cocotb
import numpy as np
from cocotb.triggers import ClockCycles, RisingEdge
from stream import Bench, StreamDriver, StreamMonitor, parameters, uniform

from models.frame_output import frame_output

FRAMES = 12


async def marks(dut, starts, ends):
    """Keep the clocks, counted from here, in which frame_start and frame_end are high while en is."""
    clock = 0
    while True:
        await RisingEdge(dut.clk)
        clock += 1
        if dut.en.value and not dut.rst.value:
            if dut.frame_start.value:
                starts.append(clock)
            if dut.frame_end.value:
                ends.append(clock)


async def send(bench, driver, frames, bad, gap):
    """Send frames, one burst a row, up to `gap` clocks apart; in_bad is right with a first word only."""
    for frame, mark in zip(frames, bad, strict=True):
        for index, row in enumerate(frame):
            if gap:
                await bench.clocks(bench.random.randint(0, gap))
            await driver.send(
                [(word, mark if index == 0 and column == 0 else not mark) for column, word in enumerate(row)]
            )


def monitors(dut):
    """Of words in, with the clock of each first word of a row; and of beats out."""
    columns = int(dut.Columns.value)
    into = StreamMonitor(dut, "in", "start", ["data", "bad"], length=columns, unsigned=("bad",))
    out = StreamMonitor(dut, "out", "valid", ["data", "last", "user"], unsigned=("last", "user"))
    return into, out


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(gap=[0, 7], pause=[0.0, 0.4])
async def frames(dut, gap, pause):
    dut._log.info("SEED=%s", os.environ["COCOTB_RANDOM_SEED"])
    width, rows, columns = parameters(dut, "Width", "Rows", "Columns")
    bench = Bench(dut, pause)
    driver = StreamDriver(dut, "in", "start", ["data", "bad"])
    into, out = monitors(dut)
    await bench.start()
    starts, ends = [], []
    cocotb.start_soon(marks(dut, starts, ends))
    words = uniform((FRAMES, rows, columns), width)
    bad = [0, 1, 0, 0, 1, 1, 0, *(bench.random.randint(0, 1) for _ in range(FRAMES - 7))]
    await send(bench, driver, words.tolist(), bad, gap)
    await bench.clocks(columns + 2)

    seen = np.array(into.words).reshape(FRAMES, rows, columns, 2)
    want = frame_output(seen[..., 0], seen[:, 0, 0, 1])
    np.testing.assert_array_equal(np.array(out.words), want)
    assert len(starts) == len(ends) == FRAMES, f"{len(starts)} frames began, {len(ends)} ended"
    if not gap and not pause:
        assert set(np.diff(starts)) == set(np.diff(ends)) == {rows * columns}
        assert ends[0] - starts[0] == rows * columns - 1


@cocotb.test(timeout_time=1, timeout_unit="ms")
@cocotb.parametrize(first_bad=[0, 1])
async def resets(dut, first_bad):
    """A frame cut short by a reset, in any of its rows, leaves no trace."""
    width, rows, columns = parameters(dut, "Width", "Rows", "Columns")
    bench = Bench(dut)
    driver = StreamDriver(dut, "in", "start", ["data", "bad"])
    _, out = monitors(dut)
    await bench.start()
    words = uniform((1, rows, columns), width)
    for row in range(rows):
        part = words[:, : row + 1].tolist()
        part[0][-1] = part[0][-1][: row % columns + 1]
        await send(bench, driver, part, [first_bad], 0)
        dut.rst.value = 1
        await ClockCycles(dut.clk, 1 + row % 2)
        dut.rst.value = 0
        out.words.clear()
        await bench.clocks(columns + 1)
        assert not out.words, f"words left after a reset in row {row}"
        await send(bench, driver, words.tolist(), [0], 0)
        await bench.clocks(1)
        np.testing.assert_array_equal(np.array(out.words), frame_output(words, [0]))
        out.words.clear()
