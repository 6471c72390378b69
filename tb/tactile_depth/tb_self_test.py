# SPDX-License-Identifier: Apache-2.0
"""Self-test of tactile_depth: the signature of its picture is that of the models, and frames do not notice."""

from itertools import repeat
from typing import Any

import cocotb
from cocotb.triggers import RisingEdge

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.self_test import self_test
from tactile_depth.chip.video.test_picture import picture
from tb.axis import broken
from tb.pixels import pack
from tb.selection import Level, case
from tb.tactile_depth.bench import CONTROL, Pipeline, started


async def signature_of_test(pipeline: Pipeline) -> int:
    """Return the signature of the self-test that was asked for, and expect what the clips of its picture leave."""
    while not (signature := await pipeline.read("SELF_TEST")):
        pass
    content, board, monitor = pipeline.tables.content, pipeline.scoreboard, Monitor()
    light = None if board.light is None else board.light.gains
    words = pack(picture(pipeline.rows, pipeline.columns)).ravel()
    board.beside |= board.frame(words, content, (light, False), monitor)[2].depth_clipped
    assert signature == self_test(pipeline.config, content.slopes, content.zero, board.dark_level, light)
    clipped = monitor.saturations.total()
    board.counters["SATURATIONS"] += clipped
    board.sticky |= {"saturation"} if clipped else set()
    return signature


@case(Level.FORMATS, whole_rows=True)
async def the_signature_is_that_of_the_models(dut: Any) -> None:
    """Test after a reset, and again with a table turned round: no depth leaves, and the next frame is as ever."""
    pipeline = await started(dut)
    assert not await pipeline.read("SELF_TEST")
    await pipeline.write("CONTROL", CONTROL.pack(self_test=1))
    first = await signature_of_test(pipeline)
    await pipeline.check()
    tables = pipeline.tables.content.entries
    name = "coefficients" if "coefficients" in tables else "gradient"  # corrections may be none
    entries = tables[name]
    await pipeline.tables.write(name, entries[::-1])
    await pipeline.tables.commit(name, entries[::-1])
    await pipeline.write("CONTROL", CONTROL.pack(self_test=1))
    assert await signature_of_test(pipeline) != first
    await pipeline.play(pipeline.frame())


@case(Level.FORMATS, whole_rows=True)
async def between_two_frames(dut: Any) -> None:
    """Ask inside a frame, with gaps and stalls, and while the guard hunts: the test waits, and no frame changes."""
    pipeline = await started(dut, offers="random", accepts="long")
    await pipeline.hold_light()
    long = broken(pipeline.frame(), "row_long", pipeline.pixels - 1, pipeline.columns)
    for frames in ([pipeline.frame(), pipeline.frame()], [long, long[1:9], pipeline.frame()]):
        sending = cocotb.start_soon(pipeline.send(*frames))
        await pipeline.until(lambda: len(pipeline.into.words) > pipeline.pixels // 2)
        await pipeline.write("CONTROL", CONTROL.pack(self_test=1))
        assert not await pipeline.read("SELF_TEST")
        await sending
        await signature_of_test(pipeline)
        await pipeline.check()


@case(Level.FORMATS)
async def a_stalled_sink_and_an_open_frame_keep_it_waiting(dut: Any) -> None:
    """Ask inside a frame that does not end, then behind a stalled sink: the test is done when each goes on."""
    pipeline = await started(dut)
    await pipeline.hold_light()
    frame = pipeline.frame()
    await pipeline.send(frame[:-1])
    await pipeline.write("CONTROL", CONTROL.pack(self_test=1))
    for _ in range(4 * pipeline.pixels):
        await RisingEdge(dut.clk)
    assert not await pipeline.read("SELF_TEST")
    await pipeline.send(frame[-1:])
    await signature_of_test(pipeline)
    pipeline.sink.stall(repeat(False))
    await pipeline.send(pipeline.frame())
    await pipeline.until(lambda: int(dut.m_axis_tvalid.value))
    await pipeline.write("CONTROL", CONTROL.pack(self_test=1))
    for _ in range(4 * pipeline.pixels):
        await RisingEdge(dut.clk)
    assert not await pipeline.read("SELF_TEST")
    pipeline.disturb(*pipeline.profiles)
    await signature_of_test(pipeline)
    pipeline.stalled = True
    await pipeline.check()
