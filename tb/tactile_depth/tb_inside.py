# SPDX-License-Identifier: Apache-2.0
"""Test of tactile_depth that sets a register inside, because its count takes too long to reach at the pins."""

from typing import Any

from tactile_depth.chip.latency import first_depth_latency
from tb.selection import case
from tb.tactile_depth.bench import started


@case(inside=True)
async def the_clock_comes_round(dut: Any) -> None:
    """Let the count of cycles return to 0 anywhere while a frame is in flight: the measured latency does not change."""
    pipeline = await started(dut)
    for ahead in (5, pipeline.pixels // 2, pipeline.pixels + 5, first_depth_latency(pipeline.config)):
        getattr(dut, "u_pipeline", dut).u_video.now.value = (1 << 32) - ahead
        await pipeline.play(pipeline.frame())
        assert pipeline.scoreboard.latency == first_depth_latency(pipeline.config)
    await pipeline.play(pipeline.frame())
