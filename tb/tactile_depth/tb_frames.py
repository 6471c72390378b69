# SPDX-License-Identifier: Apache-2.0
"""Frames through tactile_depth: codes, latencies and intervals with gaps and stalls, at the limits of the words."""

from itertools import pairwise, product, repeat
from typing import Any

import cocotb
from cocotb.triggers import ClockCycles, RisingEdge

from tactile_depth.chip.latency import first_depth_latency
from tactile_depth.chip.limits import COLUMNS
from tactile_depth.chip.registers.register_map import REGISTERS
from tactile_depth.chip.tactile_depth import default_parameters, top_parameters
from tb.axis import PROFILES
from tb.selection import Level, case, up_to
from tb.settings import RUN
from tb.stream import MANY, configuration, parametrize
from tb.tactile_depth.bench import CONTROL, started
from tb.tactile_depth.scoreboard import STATUS

SOLVER = list(COLUMNS).index(configuration().solver)
PAIRS = list(product(PROFILES, PROFILES))  # of gaps and stalls
OFTEN = [("random", "random"), ("random", "one_in_4")]  # pairs that every build is tested with


def half(solver: int) -> list[tuple[str, str]]:
    """Return every second pair of gaps and stalls; the two solvers together are tested with all pairs."""
    return [pair for number, pair in enumerate(PAIRS) if (number + number // len(PROFILES)) % 2 == solver]


def others(pairs: list[tuple[str, str]], but: list[tuple[str, str]]) -> list[tuple[str, str]]:
    return [pair for pair in pairs if pair not in but]


@case(Level.FIRST, whole_rows=True)
async def the_configuration_is_that_of_the_models(dut: Any) -> None:
    """Compare every field that the models derive with the device, except those that the test replaced.

    The pitch and the tables' CRC belong to a calibration and are not derived.
    """
    pipeline = await started(dut)
    derived = top_parameters(pipeline.config) | RUN.device.get("parameters", {})
    word = dut.Config.value
    device = {name: word[32 * n + 31 : 32 * n].to_signed() for n, name in enumerate(default_parameters())}
    of_calibration = dict.fromkeys(("PitchNm", "TablesCrc"))
    assert device | of_calibration == derived | of_calibration
    assert await pipeline.read("GRID") == REGISTERS["GRID"].pack(rows=pipeline.rows, columns=pipeline.columns)


@case(Level.FIRST, whole_rows=True)
async def one_frame(dut: Any) -> None:
    """Send one frame: it drains without a successor, with the latencies of tactile_depth.chip.latency."""
    pipeline = await started(dut)
    await pipeline.play(pipeline.frame())
    assert pipeline.scoreboard.latency == first_depth_latency(pipeline.config)
    await pipeline.idle()


@case(whole_rows=True)
async def nothing_unknown(dut: Any) -> None:
    """Check that handshakes, side-bands and contact are 0 or 1 from the second cycle after reset on, valid or not."""
    pipeline = await started(dut, accepts="random")
    await RisingEdge(dut.clk)
    sending = cocotb.start_soon(pipeline.send(pipeline.frame()))
    names = "s_axis_tready m_axis_tvalid m_axis_tlast m_axis_tuser m_event_tvalid contact irq s_axil_awready"
    pins = [getattr(dut, pin) for pin in f"{names} s_axil_wready s_axil_bvalid s_axil_arready s_axil_rvalid".split()]
    for _ in range(first_depth_latency(pipeline.config) + pipeline.pixels):
        await RisingEdge(dut.clk)
        for pin in pins:
            assert pin.value.is_resolvable, f"{pin._name} is {pin.value}"
    await sending
    await pipeline.check()


@case(Level.STREAM)
async def back_to_back(dut: Any) -> None:
    """Send frames back to back: one leaves exactly every N^2 cycles, and every latency is the same."""
    pipeline = await started(dut)
    frames = 6
    sending = cocotb.start_soon(pipeline.send(*(pipeline.frame() for _ in range(frames))))
    counted = set()
    while len(pipeline.out.words) < (frames - 1) * pipeline.pixels:
        counted.add(await pipeline.read("FIRST_DEPTH_LATENCY"))
    assert counted == {0, first_depth_latency(pipeline.config)}, "counted by the hardware, over all frames"
    await sending
    checked = await pipeline.check()
    (first, _), *_, (_, last) = checked.taken
    assert last - first == frames * pipeline.pixels - 1, "the input was not taken at one pixel per cycle"
    latencies = {depth - first for depth, (first, _) in zip(checked.first_depths, checked.taken, strict=True)}
    assert latencies == {first_depth_latency(pipeline.config)}
    intervals = {after - before for before, after in pairwise(checked.first_depths)}
    assert intervals == {pipeline.pixels}


@case(Level.STREAM, whole_rows=True)
@parametrize(
    (
        ("offers", "accepts"),
        up_to(
            {
                Level.STREAM: OFTEN[:1],
                Level.FORMATS: OFTEN[1:],
                Level.DISTURBED: others(half(SOLVER), OFTEN),
                Level.LONG: others(PAIRS, OFTEN + half(SOLVER)),
            }
        ),
    )
)
async def gaps_and_stalls(dut: Any, offers: str, accepts: str) -> None:
    """Send frames with gaps and stalls: no code changes or is lost. Some frames end while the output is stalled."""
    pipeline = await started(dut, offers=offers, accepts=accepts)
    await pipeline.send(*(pipeline.frame() for _ in range(2 if accepts == "none" else 5)))
    await pipeline.drain()
    into, out = pipeline.into, pipeline.out
    gaps = any(since > taken + 1 for taken, since in zip(into.taken, into.offered[1:], strict=False))
    assert gaps or offers == "none", "the test is void: the source never pauses"
    assert out.taken != out.offered or accepts == "none", "the test is void: the sink never stalls"
    await pipeline.check()


@case(whole_rows=True)
async def a_sink_that_waits_for_long(dut: Any) -> None:
    """Stall the sink for long: the input stops, then every frame leaves, and a later frame has its usual latency."""
    pipeline = await started(dut)
    pipeline.stalled = True
    pipeline.sink.stall(repeat(False))
    frames = cocotb.start_soon(pipeline.send(*(pipeline.frame() for _ in range(6))))
    await ClockCycles(dut.clk, 5 * pipeline.pixels)
    taken = len(pipeline.into.words)
    await ClockCycles(dut.clk, 2 * pipeline.pixels)
    assert len(pipeline.into.words) == taken < 6 * pipeline.pixels, "the input did not stop"
    pipeline.sink.stall(repeat(True))
    await frames
    await pipeline.check()
    pipeline.stalled = False
    await pipeline.play(pipeline.frame())
    assert pipeline.scoreboard.latency == first_depth_latency(pipeline.config)


@case()
async def many_frames(dut: Any) -> None:
    """Reach ties of every rounding, and clip every value that can clip, with random colours."""
    pipeline = await started(dut)
    await pipeline.play(*(pipeline.frame() for _ in range(MANY)))


@case(Level.FORMATS, whole_rows=True)
@parametrize(accepts=["none", "random"])
async def saturation(dut: Any, accepts: str) -> None:
    """Send a pyramid deeper than full scale: it is clipped where the model clips, counted and flagged, and never
    wraps."""
    pipeline = await started(dut, accepts=accepts)
    steep = pipeline.pressed(slope=1.0)
    await pipeline.send(steep, pipeline.frame(), steep)
    codes = (await pipeline.check()).codes
    assert pipeline.scoreboard.counters["SATURATIONS"] > 0, "the test is void: nothing clips"
    limit = 1 << pipeline.config.data_width - 1
    assert codes.max() == limit - 1 or codes.min() == -limit, "no depth at full scale"
    await pipeline.clear_status(**dict.fromkeys(pipeline.scoreboard.sticky, 1))
    await pipeline.play(pipeline.plain())
    assert not pipeline.scoreboard.sticky


@case(Level.FORMATS)
@parametrize(taken=[0, 5])
async def depth_frames_are_dropped(dut: Any, taken: int) -> None:
    """Stall the sink with drop_frames set: frames are lost, the input never waits, and the next frame is whole.

    The sink takes about `taken` words of the first frame.
    """
    pipeline = await started(dut)
    frames = [pipeline.plain(), pipeline.plain(), pipeline.pressed(), pipeline.plain()]
    codes = pipeline.depth_of(*frames)
    await pipeline.write("THRESHOLD", int(codes[2].max()) - 1)
    await pipeline.write("CONTROL", CONTROL.pack(drop_frames=1))
    pipeline.sink.stall(len(pipeline.out.words) < taken for _ in repeat(None))
    began = pipeline.into.clock_count
    await pipeline.send(*frames[:2], frames[2][: pipeline.columns])
    await ClockCycles(dut.clk, pause := 20)  # so that the first frame's latency and the last one's differ
    await pipeline.send(frames[2][pipeline.columns :])
    assert pipeline.into.clock_count - began < 3 * pipeline.pixels + pause + 8, "the input waited"
    await ClockCycles(dut.clk, first_depth_latency(pipeline.config) + pipeline.pixels)
    assert dut.contact.value, "contact waits for a stalled sink"
    latency = await pipeline.read("FIRST_DEPTH_LATENCY")
    assert latency == first_depth_latency(pipeline.config), f"{latency} is the latency of a frame that was dropped"
    assert STATUS.unpack(await pipeline.read("STATUS"))["busy"], "STATUS.busy is low while two depths wait"
    assert await pipeline.read("DEPTH_DROPPED") == 3
    status = STATUS.unpack(await pipeline.read("STATUS"))
    assert status["depth_dropped"]
    assert status["stalled"]
    waits = bool(dut.m_axis_tvalid.value), bool(dut.m_axis_tuser.value)
    assert waits == (True, not taken), f"the test is void: valid and start of the depth that waits are {waits}"
    gone = len(pipeline.out.words)
    assert taken <= gone <= taken + bool(taken) * (2 * pipeline.config.lanes - 1)
    pipeline.sink.stall(repeat(True))
    await ClockCycles(dut.clk, 8)
    await pipeline.send(frames[3])
    await pipeline.idle()
    await ClockCycles(dut.clk, 4 * pipeline.columns)
    left = [pipeline.contact.signed(beat.data) for beat in pipeline.out.words]
    part = codes[0].flat[: gone + pipeline.held]
    assert left == [*part.tolist(), *codes[3].flat], "the words left that fit before the stall, then a whole frame"
    assert await pipeline.read("FRAMES_OUT") == 1
    assert await pipeline.read("FIRST_DEPTH_LATENCY") == latency
    assert len(pipeline.contact.packets) == len(frames), "each frame has its record"
    pipeline.contact.check_with_drops(codes, pipeline.into.taken[pipeline.pixels - 1 :: pipeline.pixels])
    await pipeline.reset(2)
