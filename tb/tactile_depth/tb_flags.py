# SPDX-License-Identifier: Apache-2.0
"""Flags of frames of tactile_depth: each check compares those of every record; here frames have one after another."""

from typing import Any

from tb.axis import broken
from tb.selection import Level, case
from tb.stream import parametrize
from tb.tactile_depth.bench import Stream, started


@case(Level.FORMATS)
@parametrize(accepts=["none", "random"])
async def flags_of_frames(dut: Any, accepts: str) -> None:
    """Send frames with steep, clipped and dark pixels, plain ones and broken ones side by side, then a plain one
    alone: each has its own flags."""
    pipeline = await started(dut, offers="random", accepts=accepts)
    limit = 30
    await pipeline.write("SLOPE_LIMIT", limit)
    pipeline.scoreboard.slope_limit = limit
    plain, steep = pipeline.plain(), pipeline.pressed(slope=1.0)
    dark = [word._replace(data=0) if n % 3 else word for n, word in enumerate(pipeline.frame())]
    await pipeline.write("DARK_LEVEL", 1)
    pipeline.scoreboard.dark_level = 1
    faulty = [broken(frame, "row_short", 3, pipeline.columns) for frame in (steep, plain)]
    streams: list[Stream] = [plain, steep, plain, dark, plain, faulty[0], plain, plain, steep, faulty[1], steep]
    await pipeline.send(*streams)
    flags = (await pipeline.check()).flags
    names = ["depth_clipped", "resumed", "steep", *["dark"] * pipeline.config.flat_field]
    for name in names:
        seen = {bool(getattr(each, name)) for each in flags}
        assert seen == {True, False}, f"the test is void: {name} is {seen}"
    await pipeline.play(plain)
