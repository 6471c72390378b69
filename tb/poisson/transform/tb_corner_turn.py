# SPDX-License-Identifier: Apache-2.0
"""corner_turn against its model: positions, latency from the last word; gaps between frames, pauses, reset."""

from typing import Any

import cocotb

from tactile_depth.poisson.transform.corner_turn import LATENCY, corner_turn
from tb.lanes import BeatMonitor, check_lanes
from tb.stream import parameters, places, sample, with_and_without_en

FRAMES, ROWS = 3, 7


async def check(dut: Any, rows: int = ROWS, **behaviour: Any) -> None:
    columns, width, lanes = parameters(dut, "Columns", "Width", "Lanes")
    frames = places(FRAMES * rows * columns, width).reshape(FRAMES, rows, columns)
    behaviour |= {"lanes": lanes, "sink": BeatMonitor(dut, "out", columns // lanes, lanes)}
    await check_lanes(dut, frames, lambda rows, _: corner_turn(rows, lanes), columns - 1 + LATENCY, **behaviour)


@cocotb.test(timeout_time=2, timeout_unit="ms")
@cocotb.parametrize((("gap", "pause"), sample([(0, 0.0), (30, 0.0), (0, 0.3), (30, 0.3)])))
async def frames(dut: Any, gap: int, pause: float) -> None:
    await check(dut, gap=gap, pause=pause)


@cocotb.test(timeout_time=2, timeout_unit="ms")
@cocotb.parametrize(rows=[1, 2, 21])
async def any_number_of_rows(dut: Any, rows: int) -> None:
    await check(dut, rows)


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def reset_in_mid_frame(dut: Any) -> None:
    """Reset in each cycle of a step as rows begin to enter, and as they leave."""
    columns, lanes = parameters(dut, "Columns", "Lanes")
    step = columns // lanes
    await check(dut, interrupts=with_and_without_en([*range(1, step + 1), *range(columns, columns + step + 4)]))


@cocotb.test(timeout_time=2, timeout_unit="ms")
@cocotb.parametrize(strays=[1, 3])
async def a_frame_begins_afresh(dut: Any, strays: int) -> None:
    await check(dut, strays=strays)
