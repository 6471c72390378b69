# SPDX-License-Identifier: Apache-2.0
"""forward_elimination against its model: codes, latency, saturations; gaps, pauses, reset."""

import math

import cocotb
import numpy as np

from tactile_depth.latency import FORWARD_ELIMINATION
from tactile_depth.poisson.forward_elimination import forward_elimination
from tb.stream import MANY, check_bursts, configuration, corners, uniform


async def check(dut, amplitude, frames=3, **behaviour):
    """Random words up to an amplitude; None: mostly the lowest and the highest; infinite: all the highest."""
    config = configuration()

    def model(x, monitor):
        return forward_elimination(x.reshape(-1, config.rows, config.columns), config, monitor)

    shape, width = (frames * config.rows, config.columns, 1), config.arithmetic_width
    if amplitude == math.inf:
        words = np.full(shape, (1 << width - 1) - 1)
    else:
        words = corners(shape, width) if amplitude is None else uniform(shape, width, amplitude)
    behaviour |= {"in_fields": ["data"], "out_fields": ["data"], "frame": config.rows}
    await check_bursts(dut, words, model, FORWARD_ELIMINATION, **behaviour)


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(gap=[0, 30], pause=[0.0, 0.3], amplitude=[0.01, 1.0])
async def frames(dut, gap, pause, amplitude):
    await check(dut, amplitude, gap=gap, pause=pause)


@cocotb.test(timeout_time=50, timeout_unit="ms")
@cocotb.parametrize(amplitude=[0.003, 0.1, None])
async def many_frames(dut, amplitude):
    """Ties of every rounding, and clips of every one that can."""
    await check(dut, amplitude, frames=MANY)


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(amplitude=[0.1, None])
async def reset_in_mid_frame(dut, amplitude):
    """As the first words enter and leave, and in the midst of the frame, with en and without; as values are clipped."""
    config = configuration()
    inner = config.columns * (config.rows // 2) + config.columns // 2
    counts = [*range(1, FORWARD_ELIMINATION + 4), *range(inner, inner + 4)]
    await check(dut, amplitude, interrupts=[count for count in counts for _ in "en"])


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(strays=[1, 2, 11])
async def a_frame_begins_afresh(dut, strays):
    """After part of a frame, and after more than one without a start in between."""
    await check(dut, 0.1, frames=1, strays=strays)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def reset_as_the_mean_is_clipped(dut):
    """In each of the clocks behind the addend of the last row but one, with en and without: nothing is counted."""
    config = configuration()
    last_addend = config.columns * (config.rows - 2) + FORWARD_ELIMINATION
    clocks = range(last_addend - 4, last_addend + 7)
    await check(dut, math.inf, interrupts=[count for count in clocks for _ in "en"])
