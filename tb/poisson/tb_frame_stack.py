# SPDX-License-Identifier: Apache-2.0
"""frame_stack against its model: positions, latency, pairs of rows without a pause; gaps, pauses, reset."""

from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import RisingEdge

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.poisson.frame_stack import LEAD, frame_stack, latency
from tb.beats import BeatsDriver, BeatsMonitor
from tb.pairs import AloneMonitor, PairMonitor, side_by_side
from tb.stream import Bench, check_frame_starts, check_words, interrupt, parameters, parametrize, places, sample
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Columns Width Rows InWords Lanes WordsPerRow")
STRUCTURES = (
    built(32, 24, 9, 4, 16, 8, on=VERILATOR),
    built(16, 16, 8, 2, 8, 4, on=ICARUS),
    built(8, 10, 5, 1, 1, 3, on=ICARUS, mutants=ICARUS),
    built(8, 10, 8, 1, 2, 1, on=ICARUS, mutants=ICARUS),
    built(16, 11, 7, 2, 8, 4, on=ICARUS, mutants=ICARUS),
    built(64, 16, 6, 4, 32, 16, on=ICARUS),
    built(16, 16, 8, 1, 1, 1),
    built(16, 16, 9, 1, 2, 2),
    built(64, 16, 7, 8, 16, 8),
    built(128, 16, 9, 8, 64, 32),
)
PROOFS = tuple(
    Proof(
        "rows and beats are only counted; memories with the words of a clock and of several; words as fast as they "
        f"leave and slower; an even and an odd number of rows; {WORD_FREE}",
        {"Rows": rows, "Columns": columns, "InWords": in_words, "Lanes": lanes, "WordsPerRow": words},
        steps=1,
    )
    for rows, columns, in_words, lanes, words in ((5, 8, 1, 1, 3), (4, 8, 1, 2, 1), (4, 16, 2, 4, 1), (5, 16, 2, 8, 4))
)


FRAMES = 5  # in place, the order of rows in the memory flips with every frame


async def idle(dut: Any, cycles: int) -> None:
    """Wait for as many cycles with en as a driver does, to the last one; `Bench.clocks` ends one early in a pause."""
    for _ in range(cycles):
        await RisingEdge(dut.clk)
        while not dut.en.value:
            await RisingEdge(dut.clk)


async def check(
    dut: Any, count: int = FRAMES, gap: int = 0, pause: float = 0.0, interrupts: Any = (), strays: int = 0
) -> None:
    """Send frames of places and compare; for `interrupts` and `strays` see stream.check_bursts."""
    columns, width, rows, words, lanes = parameters(dut, "Columns", "Width", "Rows", "InWords", "Lanes")
    paths = max(1, lanes // 2)
    clocks, pairs, beats = columns // words, (rows + 1) // 2, columns // paths
    # One word per frame is left out, so that every bit of a position changes from frame to frame.
    sent = places(count * (2 * rows * columns + 1), width).reshape(count, -1)[:, 1:]
    bursts = sent.reshape(count * rows, clocks, 2 * words)
    bench = Bench(dut, pause)
    driver = BeatsDriver(dut, "in", ["last", "ahead"], words, LEAD)
    source = BeatsMonitor(dut, "in", ["last", "ahead"], clocks, words, LEAD)
    sink, alone = PairMonitor(dut, "out", beats, paths, rows, LEAD), AloneMonitor(dut, "out")
    await bench.start()

    leaves = (pairs - 1) * 2 * columns // lanes + (beats if rows % 2 else 2 * columns // lanes)
    slower = max(0, leaves - rows * clocks)  # a frame leaves as fast as the next one comes

    async def send(words: int) -> None:
        for index, begin in enumerate(range(0, words, clocks)):
            if index % rows == 0:
                await idle(dut, slower)
            driver.frame_start = index % rows == 0
            await driver.send(bursts[index % len(bursts), : words - begin].tolist())

    first = latency(columns, words, paths)
    await interrupt(bench, send, interrupts, (source, sink), first + LEAD + 4)
    await send(strays * clocks)
    for index, burst in enumerate(bursts):
        await idle(dut, bench.random.randint(0, gap) + (slower if index % rows == 0 else 0))
        driver.frame_start = index % rows == 0
        await driver.send(burst.tolist())
    await bench.clocks(leaves + first + 2 * LEAD + 4)
    source.forget_but(len(bursts))
    sink.forget_but(count * pairs)
    last, ahead = np.moveaxis(np.array(source.words).reshape(count, rows, clocks, 2, words), 3, 0)
    stored = np.concatenate((ahead[:, 1:], last[:, -1:]), axis=1).reshape(count, rows, columns)
    check_words(np.array(sink.words), side_by_side(frame_stack(stored), paths).reshape(-1, 2 * paths), beats, pairs)
    check_frame_starts([source], rows)
    check_frame_starts([sink], pairs)
    assert alone.marks[-count * pairs :] == [
        rows % 2 != 0 and pair % pairs == pairs - 1 for pair in range(count * pairs)
    ]
    last_rows, first_out = source.starts[rows - 1 :: rows], sink.starts[::pairs]
    delays = {out - row for out, row in zip(first_out, last_rows, strict=True)}
    assert delays == {first}, delays
    apart = np.diff(np.array(sink.starts).reshape(count, pairs), axis=1)
    assert np.all(apart == 2 * columns // lanes), "a frame leaves with a pause between two pairs"


@cocotb.test
@parametrize((("gap", "pause"), sample([(0, 0.0), (5, 0.0), (80, 0.0), (0, 0.3), (30, 0.3)])))
async def frames(dut: Any, gap: int, pause: float) -> None:
    await check(dut, gap=gap, pause=pause)


@cocotb.test
async def resets(dut: Any) -> None:
    """Reset amid a frame, and in each cycle around the end of its last row, where the reading side begins."""
    columns, rows, words, lanes = parameters(dut, "Columns", "Rows", "InWords", "Lanes")
    clocks, beats = columns // words, columns // max(1, lanes // 2)
    around = range(max(0, clocks - beats - 2), clocks + LEAD + 2)
    amid = [(rows * halves + 1) * clocks // 2 for halves in (1, 3, 5)]
    await check(dut, 2, interrupts=[*amid, *((rows - 1) * clocks + clock for clock in around)])


@cocotb.test
@parametrize(strays=[1, 4, 11])
async def a_frame_begins_afresh(dut: Any, strays: int) -> None:
    """Start a frame after part of another one, and after more than one without a start of frame in between."""
    await check(dut, 2, strays=strays)
