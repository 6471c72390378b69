# SPDX-License-Identifier: Apache-2.0
"""row_order against its model: positions and the latency from the last word; gaps inside rows, pauses and resets."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import ONE_ORDER, WORD_FREE, Proof
from tactile_depth.chip.poisson.transform.commutator import LEAD, to_beats
from tactile_depth.chip.poisson.transform.row_order import LATENCY, row_order
from tb.beats import BeatsMonitor
from tb.stream import (
    Bench,
    StreamDriver,
    StreamMonitor,
    check_frame_starts,
    check_words,
    parameters,
    parametrize,
    send_words,
    uniform,
)
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Columns Width Paths")
STRUCTURES = (
    built(32, 24, 4, on=VERILATOR),
    built(16, 16, 2, on=ICARUS),
    built(8, 16, 2, on=ICARUS, mutants=ICARUS),
    built(8, 8, 4, on=ICARUS),
    built(16, 24, 1, on=ICARUS, mutants=ICARUS),
    built(64, 24, 8),
)
PROOFS = tuple(Proof(f"{ONE_ORDER}; {WORD_FREE}", {"Columns": 8, "Paths": paths}) for paths in (1, 2, 4))


ROWS = 7
FRAME = 3  # rows


async def check(dut: Any, pause: float = 0.0, **behaviour: Any) -> None:
    columns, width, paths = parameters(dut, "Columns", "Width", "Paths")
    latency, beats = LEAD + LATENCY, columns // paths
    bench = Bench(dut, pause)
    driver = StreamDriver(dut, "in", "valid", ["data"])
    source = StreamMonitor(dut, "in", "valid", ["data"])
    sink = BeatsMonitor(dut, "out", ["data"], beats, paths)
    rows = uniform((ROWS, columns), width)
    behaviour |= {"frame": FRAME * columns, "quiet": latency + beats + 4}
    await send_words(bench, driver, source, sink, rows.reshape(-1, 1).tolist(), **behaviour)
    sink.forget_but(ROWS)
    order = to_beats(row_order(rows), paths, beats.bit_length() - 1)
    check_words(np.array(sink.words), order.reshape(-1, paths), beats, FRAME)
    check_frame_starts([source], FRAME * columns)
    check_frame_starts([sink], FRAME)
    ends = source.starts[columns - 1 :: columns]
    assert [start - end for start, end in zip(sink.starts, ends, strict=True)] == [latency] * ROWS


@cocotb.test
@parametrize(gap=[0.0, 0.1, 0.8], pause=[0.0, 0.3])
async def rows(dut: Any, gap: float, pause: float) -> None:
    await check(dut, pause, gap=gap)


@cocotb.test
async def reset_in_mid_row(dut: Any) -> None:
    """Reset at each word of a row, and while the row leaves."""
    (columns,) = parameters(dut, "Columns")
    await check(dut, interrupts=range(1, columns + columns // 2))


@cocotb.test
@parametrize((("rows", "words"), [(0, 1), (1, -1), (1, 1)]))
async def a_frame_begins_afresh(dut: Any, rows: int, words: Any) -> None:
    """Start a frame after `rows` rows and `words` words of an incomplete frame."""
    (columns,) = parameters(dut, "Columns")
    await check(dut, strays=rows * columns + words)
