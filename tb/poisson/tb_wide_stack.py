# SPDX-License-Identifier: Apache-2.0
"""wide_stack against its model: positions, latency, pairs of rows without a pause; gaps, pauses, reset."""

from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import RisingEdge

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.poisson.wide_stack import LEAD, latency, wide_stack
from tb.pairs import AloneMonitor, PairMonitor
from tb.stream import Bench, check_frame_starts, check_words, interrupt, parameters, parametrize, places, sample
from tb.structures import ICARUS, VERILATOR, of_parameters
from tb.wide import WideDriver, WideMonitor

built = of_parameters("Columns Width Rows InWords OutWords")
STRUCTURES = (
    built(32, 24, 9, 4, 16, on=VERILATOR),
    built(16, 16, 8, 2, 8, on=ICARUS),
    built(16, 16, 5, 2, 2, on=ICARUS, mutants=ICARUS),
    built(16, 12, 4, 2, 4, on=ICARUS, mutants=ICARUS),
    built(64, 16, 3, 4, 32, on=ICARUS),
    built(64, 16, 7, 8, 16),
    built(128, 16, 9, 8, 64),
)
PROOFS = tuple(
    Proof(
        "rows and beats are only counted; a memory with the words of a clock, and one with a part of them; an even and "
        f"an odd number of rows; {WORD_FREE}",
        {"Rows": rows, "Columns": columns, "InWords": in_words, "OutWords": out_words},
        steps=2,
    )
    for rows, columns, in_words, out_words in ((3, 8, 2, 4), (4, 8, 2, 4), (4, 16, 2, 2))
)


FRAMES = 4  # in place, the order of rows in the memory flips with every frame


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
    columns, width, rows, paths, words = parameters(dut, "Columns", "Width", "Rows", "InWords", "OutWords")
    clocks, pairs = columns // paths, (rows + 1) // 2
    # One word per frame is left out, so that every bit of a position changes from frame to frame.
    sent = places(count * (2 * rows * columns + 1), width).reshape(count, -1)[:, 1:]
    bursts = sent.reshape(count * rows, clocks, 2 * paths)
    bench = Bench(dut, pause)
    driver = WideDriver(dut, "in", ["last", "ahead"], paths)
    source = WideMonitor(dut, "in", ["last", "ahead"], clocks, paths)
    sink, alone = PairMonitor(dut, "out", columns // words, words, rows, LEAD), AloneMonitor(dut, "out")
    await bench.start()

    slower = max(0, 2 * pairs * columns // words - rows * clocks)  # a frame leaves as fast as the next one comes

    async def send(words: int) -> None:
        for index, begin in enumerate(range(0, words, clocks)):
            if index % rows == 0:
                await idle(dut, slower)
            driver.frame_start = index % rows == 0
            await driver.send(bursts[index % len(bursts), : words - begin].tolist())

    quiet = latency(columns, paths, words) + 4
    await interrupt(bench, send, interrupts, (source, sink), quiet)
    await send(strays * clocks)
    for index, burst in enumerate(bursts):
        await idle(dut, bench.random.randint(0, gap) + (slower if index % rows == 0 else 0))
        driver.frame_start = index % rows == 0
        await driver.send(burst.tolist())
    await bench.clocks(2 * pairs * columns // words + quiet + LEAD)
    source.forget_but(len(bursts))
    sink.forget_but(count * pairs)
    last, ahead = np.moveaxis(np.array(source.words).reshape(count, rows, clocks, 2, paths), 3, 0)
    stored = np.concatenate((ahead[:, 1:], last[:, -1:]), axis=1).reshape(count, rows, columns)
    beats = wide_stack(stored, words)
    expected = np.zeros((count, 2 * pairs, *beats.shape[2:]), np.int64)
    expected[:, :rows] = beats
    check_words(np.array(sink.words), expected.reshape(-1, words), columns // words, 2 * pairs)
    check_frame_starts([source], rows)
    check_frame_starts([sink], pairs)
    assert alone.marks[-count * pairs :] == [
        rows % 2 != 0 and pair % pairs == pairs - 1 for pair in range(count * pairs)
    ]
    last_rows, first_out = source.starts[rows - 1 :: rows], sink.starts[::pairs]
    delays = {out - row for out, row in zip(first_out, last_rows, strict=True)}
    assert delays == {latency(columns, paths, words)}, delays
    apart = np.diff(np.array(sink.starts).reshape(count, pairs), axis=1)
    assert np.all(apart == 2 * columns // words), "a frame leaves with a pause between two pairs"


@cocotb.test(timeout_time=2, timeout_unit="ms")
@parametrize((("gap", "pause"), sample([(0, 0.0), (5, 0.0), (80, 0.0), (0, 0.3), (30, 0.3)])))
async def frames(dut: Any, gap: int, pause: float) -> None:
    await check(dut, gap=gap, pause=pause)


@cocotb.test(timeout_time=2, timeout_unit="ms")
@parametrize(halves=[1, 3, 5])
async def reset_in_mid_frame(dut: Any, halves: int) -> None:
    columns, rows, paths = parameters(dut, "Columns", "Rows", "InWords")
    clocks = columns // paths
    await check(dut, 2, interrupts=[halves * clocks * rows // 2 + clocks // 2])


@cocotb.test(timeout_time=4, timeout_unit="ms")
async def resets_as_a_frame_begins_to_leave(dut: Any) -> None:
    """Reset in each cycle around the end of a frame's last row, where each register of the reading side is set."""
    columns, rows, paths, words = parameters(dut, "Columns", "Rows", "InWords", "OutWords")
    clocks = columns // paths
    around = range(clocks - columns // words // 2 - 4, clocks + LEAD + 2)
    await check(dut, 2, interrupts=[(rows - 1) * clocks + clock for clock in around])


@cocotb.test(timeout_time=5, timeout_unit="ms")
@parametrize(strays=[1, 2, 11])
async def a_frame_begins_afresh(dut: Any, strays: int) -> None:
    """Start a frame after part of another one, and after more than one without a start of frame in between."""
    await check(dut, 2, strays=strays)
