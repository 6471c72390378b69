# SPDX-License-Identifier: Apache-2.0
"""Captures of tactile_depth: reference and zero offset measured from frames, and dark pixels."""

from collections.abc import Sequence
from typing import Any

import cocotb
from cocotb.triggers import RisingEdge

from tactile_depth.chip.depth.zero_capture import captured_zero
from tactile_depth.chip.gradient.flat_field import captured_gains
from tactile_depth.chip.latency import first_depth_latency
from tactile_depth.chip.registers.axil_port import Response
from tactile_depth.chip.registers.register_map import REGISTERS
from tactile_depth.chip.table_entries import one_word, reference_entries
from tb.axis import broken, video
from tb.pixels import pack, unpack
from tb.selection import Level, case
from tb.tactile_depth.bench import HEAD_CLOCKS, Pipeline, Stream, started

REFERENCE_CAPTURE, ZERO_CAPTURE = REGISTERS["REFERENCE_CAPTURE"], REGISTERS["ZERO_CAPTURE"]
DARK_LEVEL = 50


async def capturing(pipeline: Pipeline, register: str) -> bool:
    """Return True while a capture runs."""
    return bool(REGISTERS[register].unpack(await pipeline.read(register))["busy"])


def ahead(pipeline: Pipeline) -> list[Stream]:
    """Return frames whose depth leaves, and stalls, while the frames behind them enter."""
    return [pipeline.frame() for _ in range(first_depth_latency(pipeline.config) // pipeline.pixels + 1)]


@case(Level.FORMATS, needs=lambda config: not config.flat_field)
async def a_capture_without_a_reference_is_refused(dut: Any) -> None:
    """Start a capture of the reference in a build without a flat field: it is refused."""
    pipeline = await started(dut)
    assert await pipeline.write("REFERENCE_CAPTURE", REFERENCE_CAPTURE.pack(start=1, log2_frames=1)) == Response.SLVERR
    assert not await capturing(pipeline, "REFERENCE_CAPTURE")


@case(Level.FORMATS, needs=lambda config: not config.zero_offset)
async def a_capture_without_a_zero_is_refused(dut: Any) -> None:
    """Start a capture of the zero offset in a build without the zero offset: it is refused."""
    pipeline = await started(dut)
    assert await pipeline.write("ZERO_CAPTURE", ZERO_CAPTURE.pack(start=1, log2_frames=1)) == Response.SLVERR
    assert not await capturing(pipeline, "ZERO_CAPTURE")


@case(Level.FORMATS, needs=lambda config: config.flat_field)
async def reference(dut: Any) -> None:
    """Capture two frames after a broken one: the colours of later frames are relative to their mean."""
    pipeline = await started(dut, accepts="random")
    rng, columns = pipeline.random, pipeline.columns
    await pipeline.send(*ahead(pipeline))
    shades = [pack([[rng.randint(90, 160) for _ in range(3)] for _ in range(pipeline.pixels)]) for _ in range(2)]
    still = [video(shade, columns) for shade in shades]
    assert await pipeline.write("REFERENCE_CAPTURE", REFERENCE_CAPTURE.pack(start=1, log2_frames=1)) == Response.OKAY
    await pipeline.send(broken(pipeline.frame(), "row_short", 1, columns), *still, pipeline.pressed())
    while await capturing(pipeline, "REFERENCE_CAPTURE"):
        await RisingEdge(dut.clk)
    await pipeline.check()
    colours = unpack(shades).reshape(2, pipeline.rows, columns, 3)
    pipeline.tables.use("reference", reference_entries(captured_gains(colours, pipeline.config)))
    await pipeline.play(pipeline.pressed(), still[0])
    await pipeline.reset(2)
    await pipeline.play(pipeline.pressed())


@case(Level.FORMATS, needs=lambda config: config.zero_offset)
async def zero(dut: Any) -> None:
    """Capture the zero offset from two frames with a broken one between them, while more frames stream.

    Frames that begin before the capture ends keep the old one from first depth to last. Later frames use the new one.
    Both kinds are in the pipeline at once.
    """
    pipeline = await started(dut, offers="random", accepts="one_in_4")
    tables, into = pipeline.tables, pipeline.into
    await pipeline.hold_light()
    assert await pipeline.write("ZERO_CAPTURE", ZERO_CAPTURE.pack(start=1, log2_frames=1)) == Response.OKAY
    frames = [pipeline.pressed(slope) for slope in (0.25, 0.125, -0.25)]
    late = 3 + first_depth_latency(pipeline.config) // pipeline.pixels
    stream: Sequence[Stream] = frames[0], broken(pipeline.frame(), "row_short", 1, pipeline.columns), *frames[1:]
    more = (pipeline.pressed(pipeline.random.uniform(-0.3, 0.3)) for _ in range(late))
    sending = cocotb.start_soon(pipeline.send(*stream, *more))
    asked = answered = 0  # cycles of the last read with busy set, and of the first without
    while not answered:
        began = into.clock_count
        if await capturing(pipeline, "ZERO_CAPTURE"):
            asked = began
        else:
            answered = into.clock_count
    await sending
    await pipeline.drain()
    assert not await capturing(pipeline, "ZERO_CAPTURE")
    assert not await pipeline.read("TABLE_COMMIT")

    def measured(*words: Any) -> Any:
        frames = [[word.data for word in some] for some in words]
        codes = pipeline.scoreboard.before_the_zero(frames, tables.content, light=pipeline.scoreboard.light)
        return one_word(captured_zero(codes, pipeline.config))

    old = tables.content
    new = old.with_table("zero", measured(*frames[:2]))
    sent, _ = pipeline.scoreboard.frames(into, 0)
    starts = [into.taken[frame.first] + HEAD_CLOCKS for frame in sent]
    candidates = [[old] * (start <= answered) + [new] * (start > asked) for start in starts]
    used = pipeline.scoreboard.used(into, pipeline.out, candidates)
    later = [content is new for content in used]
    assert later == sorted(later), f"a frame had the old zero offset after one with the new zero offset: {later}"
    assert 3 < later.count(False) < len(later), "the test is void: no frame has one of the zero offsets"
    await pipeline.check(contents=used)
    tables.use("zero", measured(*frames[:2]))
    await pipeline.play(frames[0], frames[1])
    # One capture after another, the second as soon as it is accepted.
    start = ZERO_CAPTURE.pack(start=1)
    for frame in frames[1:]:
        while await pipeline.write("ZERO_CAPTURE", start) != Response.OKAY:
            pass
        await pipeline.send(frame)
        while await capturing(pipeline, "ZERO_CAPTURE"):
            pass
        assert await pipeline.write("ZERO_CAPTURE", start) == Response.SLVERR, "accepted before the change-over"
        await pipeline.check()
        await pipeline.send(frame)
        tables.use("zero", measured(frame))
        await pipeline.check()
    await pipeline.reset(2)
    await pipeline.play(frames[2])


@case(Level.FORMATS, needs=lambda config: config.flat_field)
async def dark_pixels_are_held(dut: Any) -> None:
    """Send dark pixels anywhere in a row, and a whole dark row: each is replaced and counted."""
    pipeline = await started(dut, accepts="random")
    words = [word.data for word in pipeline.pressed()]
    for row in range(pipeline.rows):
        for column in range(pipeline.columns):
            if row == 2 or pipeline.random.random() < 0.3:
                colour = [pipeline.random.randrange(DARK_LEVEL) for _ in range(3)]
                words[row * pipeline.columns + column] = int(pack(colour))
    await pipeline.write("DARK_LEVEL", DARK_LEVEL)
    pipeline.scoreboard.dark_level = DARK_LEVEL
    await pipeline.play(*ahead(pipeline), video(words, pipeline.columns), pipeline.frame())
