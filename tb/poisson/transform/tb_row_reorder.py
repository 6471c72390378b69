# SPDX-License-Identifier: Apache-2.0
"""row_reorder against its model: positions, latency from the last word; gaps inside rows, pauses, reset."""

from typing import Any

import cocotb
import numpy as np

from tactile_depth.chip.poisson.transform.row_reorder import LATENCY, row_reorder
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
)

ROWS = 7
FRAME = 3  # rows


async def check(dut: Any, gap: Any = 0.0, pause: float = 0.0, interrupts: Any = (), strays: int = 0) -> None:
    columns, width, to_burst = parameters(dut, "Columns", "Width", "ToBurst")
    bench = Bench(dut, pause)
    driver = StreamDriver(dut, "in", "valid", ["data"])
    source = StreamMonitor(dut, "in", "valid", ["data"])
    sink = StreamMonitor(dut, "out", "start", ["data"], length=columns)
    await bench.start()
    words = places(ROWS * columns, width).reshape(-1, 1).tolist()

    async def send(count: int) -> None:
        await send_apart(bench, driver, words[-count:], gap, FRAME * columns)

    await interrupt(bench, send, interrupts, (source, sink), quiet=LATENCY + 2)
    await send_apart(bench, driver, words[:strays], gap, FRAME * columns)
    await send_apart(bench, driver, words, gap, FRAME * columns)
    await bench.clocks(LATENCY + columns + 4)
    source.forget_but(len(words))
    sink.forget_but(ROWS)

    assert source.words == [tuple(word) for word in words], "the driver sent other words than the test gave it"
    rows = np.array(source.words).reshape(ROWS, columns)
    check_words(np.array(sink.words).reshape(-1, 1), row_reorder(rows, bool(to_burst)).reshape(-1, 1), columns, FRAME)
    check_frame_starts([source], FRAME * columns)
    check_frame_starts([sink], FRAME)
    ends = source.starts[columns - 1 :: columns]
    assert [start - end for start, end in zip(sink.starts, ends, strict=True)] == [LATENCY] * ROWS


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
