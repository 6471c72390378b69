# SPDX-License-Identifier: Apache-2.0
"""Light gains of tactile_depth: they follow the light of a stream, and are read, written and held by registers."""

from typing import Any

import numpy as np

from tactile_depth.chip.registers.axil_port import Response
from tactile_depth.chip.registers.axil_registers import GAINS
from tactile_depth.chip.registers.register_map import REGISTERS
from tactile_depth.chip.video.frame_guard import Word
from tb.axis import broken, video
from tb.pixels import pack, unpack
from tb.selection import Level, case
from tb.tactile_depth.bench import Pipeline, Stream, started

LIGHT = REGISTERS["LIGHT"]


def lit(pipeline: Pipeline, frame: Stream, light: tuple[float, float, float]) -> list[Word]:
    """Return a frame in another light."""
    colours = unpack([word.data for word in frame if word is not None])
    changed = np.rint(colours * light).clip(0, 255).astype(np.uint8)
    return video(pack(changed).ravel().tolist(), pipeline.columns)


async def check_gains(pipeline: Pipeline) -> None:
    """Compare the registers with the gains that the model expects of the next frame."""
    assert pipeline.scoreboard.light is not None
    read = [await pipeline.read(name) for name in GAINS]
    assert read == pipeline.scoreboard.light.gains.tolist(), f"gains are {read}"


@case(Level.FORMATS, needs=lambda config: config.light_gains)
async def light_gains_follow_a_stream(dut: Any) -> None:
    """Change the light, with contacts and a broken frame: every code is that of the stream model."""
    pipeline = await started(dut, offers="random")
    await check_gains(pipeline)
    for light in ((0.9, 1.0, 1.05), (0.7, 0.75, 0.8), (1.1, 1.2, 1.0)):
        faulty = broken(lit(pipeline, pipeline.frame(), light), "row_short", 1, pipeline.columns)
        frames = [lit(pipeline, pipeline.pressed(), light) for _ in range(3)]
        await pipeline.play(*frames[:2], faulty, *frames[2:])
        await check_gains(pipeline)
    assert pipeline.scoreboard.light is not None
    light_gains = pipeline.scoreboard.light
    assert (light_gains.gains != light_gains.light.unity).any(), "the test is void: no gain moved"


@case(Level.FORMATS, needs=lambda config: config.light_gains)
async def light_gains_of_single_pictures_are_written(dut: Any) -> None:
    """Write gains and hold them: the next frames use them; then they follow at a rate, and a reset sets them to 1."""
    pipeline = await started(dut)
    await pipeline.hold_light()
    stream = pipeline.scoreboard.light
    assert stream is not None
    for gains in ((0x7000, 0x8123, 0xA5FF), (0x1000, 0xFFFF, 0x8000)):
        for name, gain in zip(GAINS, gains, strict=True):
            assert await pipeline.write(name, gain) == Response.OKAY
        stream.gains = stream.light.limited(np.array(gains))
        await check_gains(pipeline)
        await pipeline.play(pipeline.pressed(), pipeline.frame())
    await pipeline.write("LIGHT", LIGHT.pack(follow=1, rate=2))
    stream.follow, stream.rate = True, 2
    await pipeline.play(pipeline.pressed(), pipeline.frame())
    await check_gains(pipeline)
    await pipeline.reset(2)
    await check_gains(pipeline)


@case(Level.FORMATS, needs=lambda config: not config.light_gains)
async def a_build_without_light_gains_ignores_them(dut: Any) -> None:
    """Write gains in a build without them: they read 0, and no code changes."""
    pipeline = await started(dut)
    for name in GAINS:
        assert await pipeline.write(name, 0x7000) == Response.OKAY
        assert await pipeline.read(name) == 0
    await pipeline.play(pipeline.pressed())
