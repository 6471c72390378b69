# SPDX-License-Identifier: Apache-2.0
"""Tests of row_reorder and wide_rows against their models.

The tests check positions and the latency from the last word, with gaps inside rows, pauses and resets.
"""

from typing import Any

import cocotb
import numpy as np

from tactile_depth.chip.poisson.transform.row_reorder import LATENCY as REORDER
from tactile_depth.chip.poisson.transform.row_reorder import row_reorder
from tactile_depth.chip.poisson.transform.wide_commutator import LEAD
from tactile_depth.chip.poisson.transform.wide_rows import LATENCY as WIDE
from tactile_depth.chip.poisson.transform.wide_rows import wide_rows
from tb.stream import (
    Bench,
    StreamDriver,
    StreamMonitor,
    check_frame_starts,
    check_words,
    interrupt,
    parameters,
    parametrize,
    places,
    send_apart,
    uniform,
)
from tb.wide import WideMonitor

ROWS = 7
FRAME = 3  # rows


async def check(dut: Any, gap: Any = 0.0, pause: float = 0.0, interrupts: Any = (), strays: int = 0) -> None:
    wide = dut._name == "wide_rows"
    columns, width, choice = parameters(dut, "Columns", "Width", "Paths" if wide else "ToBurst")
    model: Any = wide_rows if wide else row_reorder
    paths, lead = (choice, LEAD) if wide else (1, 0)
    latency, beats = lead + (WIDE if wide else REORDER), columns // paths
    bench = Bench(dut, pause)
    driver = StreamDriver(dut, "in", "valid", ["data"])
    source = StreamMonitor(dut, "in", "valid", ["data"])
    sink = WideMonitor(dut, "out", ["data"], beats, paths, lead)
    await bench.start()
    data = uniform(ROWS * columns, width) if wide else places(ROWS * columns, width)
    words = data.reshape(-1, 1).tolist()

    async def send(count: int) -> None:
        await send_apart(bench, driver, words[-count:], gap, FRAME * columns)

    await interrupt(bench, send, interrupts, (source, sink), quiet=latency + 2)
    await send_apart(bench, driver, words[:strays], gap, FRAME * columns)
    await send_apart(bench, driver, words, gap, FRAME * columns)
    await bench.clocks(latency + beats + 4)
    source.forget_but(len(words))
    sink.forget_but(ROWS)

    assert source.words == [tuple(word) for word in words], "the driver sent other words than the test gave it"
    rows = np.array(source.words).reshape(ROWS, columns)
    check_words(np.array(sink.words), model(rows, choice).reshape(-1, paths), beats, FRAME)
    check_frame_starts([source], FRAME * columns)
    check_frame_starts([sink], FRAME)
    ends = source.starts[columns - 1 :: columns]
    assert [start - end for start, end in zip(sink.starts, ends, strict=True)] == [latency] * ROWS


@cocotb.test(timeout_time=1, timeout_unit="ms")
@parametrize(gap=[0.0, 0.1, 0.8], pause=[0.0, 0.3])
async def rows(dut: Any, gap: float, pause: float) -> None:
    await check(dut, gap, pause)


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def reset_in_mid_row(dut: Any) -> None:
    """Reset at each word of a row, and while the row leaves."""
    (columns,) = parameters(dut, "Columns")
    await check(dut, interrupts=range(1, columns + columns // 2))


@cocotb.test(timeout_time=1, timeout_unit="ms")
@parametrize((("rows", "words"), [(0, 1), (1, -1), (1, 1)]))
async def a_frame_begins_afresh(dut: Any, rows: int, words: Any) -> None:
    """Start a frame after `rows` rows and `words` words of an incomplete frame."""
    (columns,) = parameters(dut, "Columns")
    await check(dut, strays=rows * columns + words)
