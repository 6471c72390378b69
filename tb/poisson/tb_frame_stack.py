# SPDX-License-Identifier: Apache-2.0
"""frame_stack against its model: positions, latency, rows without a pause in each lane; gaps, pauses, reset."""

from typing import Any

import cocotb

from formal.entries import WORD_FREE, Proof
from tactile_depth.chip.poisson.frame_stack import LATENCY, frame_stack
from tb.stream import check_frame_memory, parameters, parametrize, places, sample
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Columns Width Rows WordsPerRow")
STRUCTURES = (
    built(16, 24, 8, 3, on=VERILATOR),
    built(8, 16, 3, 1, on=ICARUS),
    built(4, 4, 3, 1, on=ICARUS),
    built(8, 16, 3, 2, on=ICARUS),
    built(4, 4, 4, 3, on=ICARUS, mutants=ICARUS),
    built(4, 4, 4, 2),
    built(5, 6, 2, 2),
    built(2, 5, 2, 6),
    built(8, 16, 2, 1),
    built(16, 16, 17, 1),
    built(16, 9, 17, 3),
    built(16, 12, 5, 6),
)
PROTOCOL = "protocol_bursts"
PROOFS = tuple(
    Proof(
        "rows, positions and memory rows are only counted; rows and memory rows no power of two, and one; words to "
        f"a memory row that divide a burst, and not; {WORD_FREE}",
        {"Rows": rows, "Columns": size, "WordsPerRow": words},
    )
    for rows, size, words in ((3, 4, 1), (4, 4, 1), (3, 4, 2), (3, 4, 3), (3, 5, 3), (2, 3, 3))
)


FRAMES = 4  # in place, the order of rows in the memory flips with every frame


async def check(dut: Any, frames: Any = FRAMES, **behaviour: Any) -> None:
    columns, width, rows = parameters(dut, "Columns", "Width", "Rows")
    # One word per frame is left out, so that every bit of a position changes from frame to frame.
    words = places(frames * (rows * columns + 1), width).reshape(frames, -1)[:, 1:]
    await check_frame_memory(dut, words, frame_stack, LATENCY, rows=rows, **behaviour)


@cocotb.test(timeout_time=2, timeout_unit="ms")
@parametrize((("gap", "pause"), sample([(0, 0.0), (5, 0.0), (80, 0.0), (0, 0.3), (30, 0.3)])))
async def frames(dut: Any, gap: float, pause: float) -> None:
    await check(dut, gap=gap, pause=pause)


@cocotb.test(timeout_time=2, timeout_unit="ms")
@parametrize(halves=[1, 3, 5])
async def reset_in_mid_frame(dut: Any, halves: int) -> None:
    columns, rows = parameters(dut, "Columns", "Rows")
    await check(dut, frames=2, interrupts=[halves * columns * rows // 2 + columns // 2])


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def resets_as_a_frame_begins_to_leave(dut: Any) -> None:
    """Reset at the first words of the last row and around its end, where each register of the reading side is set."""
    columns, rows = parameters(dut, "Columns", "Rows")
    clocks = (1, 2, 3, columns, columns + 1, columns + 2)
    await check(dut, frames=2, interrupts=[(rows - 1) * columns + clock for clock in clocks])


@cocotb.test(timeout_time=5, timeout_unit="ms")
@parametrize(strays=[1, 2, 11])
async def a_frame_begins_afresh(dut: Any, strays: int) -> None:
    """Start a frame after part of another one, and after more than one without a start of frame in between."""
    await check(dut, frames=2, strays=strays)
