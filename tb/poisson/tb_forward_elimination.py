# SPDX-License-Identifier: Apache-2.0
"""forward_elimination against its model: the tests that it shares with back_substitution, and its mean."""

import math
from typing import Any

import cocotb

from tactile_depth.chip.poisson.forward_elimination import LATENCY
from tb.poisson.elimination_bench import a_frame_begins_afresh, check, frames, many_frames, reset_in_mid_frame
from tb.stream import configuration, with_and_without_en

__all__ = ["a_frame_begins_afresh", "frames", "many_frames", "reset_as_the_mean_is_clipped", "reset_in_mid_frame"]


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def reset_as_the_mean_is_clipped(dut: Any) -> None:
    """Reset in each cycle after the addend of the last row but one: nothing is counted."""
    config = configuration()
    last_addend = config.columns * (config.rows - 2) + LATENCY
    await check(dut, math.inf, interrupts=with_and_without_en(range(last_addend - 4, last_addend + 7)))
