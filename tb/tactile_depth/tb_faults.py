# SPDX-License-Identifier: Apache-2.0
"""Malformed frames through tactile_depth: each is dropped whole, counted and flagged, and the next good frame is
right."""

from itertools import product
from typing import Any

import numpy as np
from cocotb.triggers import ClockCycles

from tactile_depth.chip.registers.register_map import WORD
from tactile_depth.chip.video.frame_guard import FAULTS, Word
from tb.axis import broken, video
from tb.selection import Level, case, named, up_to
from tb.stream import parametrize
from tb.tactile_depth.bench import CONTROL, HEAD_CLOCKS, Stream, started
from tb.tactile_depth.scoreboard import ARRIVED, STATUS, STICKY

TIMEOUT = 60  # clocks


@case(whole_rows=True)
@parametrize(fault=named(FAULTS), accepts=up_to({Level.WHOLE: ["random"], Level.LONG: ["none"]}))
async def malformed(dut: Any, fault: str, accepts: str) -> None:
    """Send A, B, A back to back with B broken: B never leaves nor sets contact, and both A are right."""
    timeout = TIMEOUT if fault == "timed_out" else 0
    pipeline = await started(dut, accepts=accepts, timeout=timeout)
    flat, pressed = pipeline.plain(), pipeline.pressed()
    codes = pipeline.depth_of(pressed, flat)
    await pipeline.write("THRESHOLD", (int(codes[0].max()) + int(codes[1].max())) // 2)
    a = [word._replace(data=word.data ^ pipeline.random.getrandbits(3)) for word in flat]
    for position in pipeline.places(fault)[: 2 if pipeline.stalled else None]:
        b = broken(pressed, fault, position, pipeline.columns, timeout + 1)
        await pipeline.send(a, b, a)
        checked = await pipeline.check()
        assert checked.faults == [fault], f"{fault} at {position}: {checked.faults}"
        assert len(checked.codes) == 2
        np.testing.assert_array_equal(checked.codes[0], checked.codes[1])
        assert not pipeline.contact.comparator.contact, f"{fault} at {position} set contact"

    bit = STATUS.pack(**{STICKY.get(fault, fault): 1})
    await pipeline.write("STATUS", WORD ^ bit)
    assert await pipeline.read("STATUS") == bit
    await pipeline.write("STATUS", bit)
    assert await pipeline.read("STATUS") == 0
    pipeline.scoreboard.sticky.clear()
    await pipeline.write("CONTROL", CONTROL.pack(clear_counters=1))
    pipeline.scoreboard.counters, pipeline.scoreboard.largest = dict.fromkeys(pipeline.scoreboard.counters, 0), 0
    await pipeline.play(a)


@case()
@parametrize(fault=up_to({Level.WHOLE: named(FAULTS[-1:]), Level.LONG: named(FAULTS[:-1])}))
async def faults_side_by_side(dut: Any, fault: str) -> None:
    """Send a broken frame between whole and broken ones: each is counted, and the whole ones are right."""
    timeout = TIMEOUT if fault == "timed_out" else 0
    pipeline = await started(dut, timeout=timeout)
    silent = timeout + pipeline.pixels  # the guard may still fill the previous frame
    for before, after in product(("good", "bad"), repeat=2):
        sides: dict[str, Stream] = {
            "good": pipeline.frame(),
            "bad": broken(pipeline.frame(), "row_short", 3, pipeline.columns),
        }
        middle = broken(pipeline.frame(), fault, pipeline.places(fault)[0], pipeline.columns, silent)
        await pipeline.send(pipeline.frame(), sides[before], middle, sides[after], pipeline.frame())
        checked = await pipeline.check()
        assert len(checked.codes) == 2 + (before == "good") + (after == "good")
        # Words without a start right after a broken frame belong to that frame.
        own = [] if fault == "start_missing" and before == "bad" else [fault]
        assert checked.faults == [*["row_short"] * (before == "bad"), *own, *["row_short"] * (after == "bad")]


@case(Level.FORMATS, whole_rows=True)
@parametrize(accepts=["none", "random"])
async def every_fault_in_a_row(dut: Any, accepts: str) -> None:
    """Send broken frames between good ones and one after another, several in flight at once."""
    pipeline = await started(dut, accepts=accepts)
    faults = [fault for fault in FAULTS if fault != "timed_out"]
    streams: list[Stream] = []
    for fault in (*faults, *reversed(faults)):
        for position in pipeline.places(fault)[:2]:
            streams.append(broken(pipeline.frame(), fault, position, pipeline.columns))
        streams.append(pipeline.frame())
    await pipeline.send(*streams)
    await pipeline.drain()
    outputs = ("idle", "taken", *["held"] * pipeline.stalled)
    missed = set(product(("idle", "taken", "held"), outputs)) - pipeline.handshakes()
    assert not missed, f"the test is void: no cycle has these states of input and output: {missed}"
    assert set((await pipeline.check()).faults) == set(faults)


@case()
@parametrize(accepts=["none", "alternate"])
async def starts_one_after_another(dut: Any, accepts: str) -> None:
    """Send starts of frame one after another: each breaks the frame before it, and the last frame is whole, with its
    own latency."""
    pipeline = await started(dut, accepts=accepts)
    reached = set()
    for count in (1, 2, 3, 5):
        starts = [word for _ in range(count) for word in pipeline.frame()[:1]]
        await pipeline.send(pipeline.frame(), starts, pipeline.frame())
        await pipeline.drain()
        reached |= pipeline.handshakes()
        assert (await pipeline.check()).faults == ["start_early"] * count
    assert not pipeline.stalled or ("start", "held") in reached, "the test is void: no start comes in a stall"


@case()
async def words_before_the_first_frame(dut: Any) -> None:
    """Send words before the first frame: they are dropped and counted as one fault, and the frame after them is
    right."""
    pipeline = await started(dut)
    await pipeline.send([word._replace(user=0) for word in pipeline.frame()[:37]], pipeline.frame())
    assert (await pipeline.check()).faults == ["start_missing"]


@case()
async def sources_that_do_not_fit(dut: Any) -> None:
    """Send frames without starts, of other widths and of other heights: ARRIVED has their size, STATUS.hunting says
    whether pixels are dropped."""
    pipeline = await started(dut)
    rows, columns = pipeline.rows, pipeline.columns

    def sized(height: int, width: int) -> list[Word]:
        return video([pipeline.random.getrandbits(24) for _ in range(height * width)], width)

    assert await pipeline.read("ARRIVED") == 0
    no_start = [word._replace(user=0) for word in sized(2 * rows, columns)]
    await pipeline.send(no_start[: 2 * columns + 3])
    await ClockCycles(dut.clk, HEAD_CLOCKS)
    assert await pipeline.read("ARRIVED") == ARRIVED.pack(rows=0, columns=columns)
    assert STATUS.unpack(await pipeline.read("STATUS"))["hunting"]
    assert await pipeline.read("FRAMES_IN") == 0
    for height, width in ((rows, columns - 1), (rows, columns + 2), (rows - 1, columns), (rows + 3, columns)):
        await pipeline.send(*[sized(height, width)] * 3)
        await ClockCycles(dut.clk, pipeline.pixels + HEAD_CLOCKS)
        assert await pipeline.read("ARRIVED") == ARRIVED.pack(rows=height, columns=width)
        hunts = STATUS.unpack(await pipeline.read("STATUS"))["hunting"]
        assert hunts == ((height, width) != (rows - 1, columns)), f"hunting is {hunts} behind {height} x {width}"
        await pipeline.play(pipeline.frame(), pipeline.frame())
        assert await pipeline.read("ARRIVED") == await pipeline.read("GRID")


@case(whole_rows=True)
async def silence(dut: Any) -> None:
    """Pause inside a frame: with TIMEOUT at 0 the pipeline waits for ever, otherwise for that many cycles."""
    pipeline = await started(dut)
    frame = pipeline.frame()
    await pipeline.send(frame[:100], [None] * 10 * pipeline.pixels, frame[100:])
    assert len((await pipeline.check()).codes) == 1
    timeout = 50
    pipeline.timeout = timeout
    pipeline.into.silence = True
    await pipeline.write("TIMEOUT", timeout)
    for clocks, waited in ((timeout, True), (timeout + 1, False), (10 * timeout, False)):
        await pipeline.send(frame[:100], [None] * clocks, frame[100:], [None] * 3 * timeout, frame)
        left = len((await pipeline.check()).codes)
        assert left == 1 + waited, f"{left} frames left after {clocks} silent cycles with TIMEOUT {timeout}"


@case()
@parametrize(offers=["none", "random"], accepts=up_to({Level.WHOLE: ["alternate", "random"], Level.LONG: ["none"]}))
async def random_streams(dut: Any, offers: str, accepts: str) -> None:
    """Send random streams of good and broken frames, stray words and pauses."""
    pipeline = await started(dut, offers=offers, accepts=accepts)
    rng = pipeline.random
    for _ in range(12):
        words = pipeline.frame()
        for _ in range(rng.choice((0, 0, 0, 1, 2))):
            place = rng.randrange(len(words))
            flip = rng.choice(("last", "user"))
            match rng.randrange(4):
                case 0:
                    words[place] = words[place]._replace(**{flip: 1 - getattr(words[place], flip)})
                case 1:
                    del words[place : place + rng.randint(1, 40)]
                case 2:
                    words[place:place] = words[place : place + rng.randint(1, 40)]
                case 3:
                    words = words[: place + 1]
        await pipeline.send(words, [None] * rng.choice((0, 0, 1, 30)))
    await pipeline.send(pipeline.frame()[:1], pipeline.frame())  # ends a frame that is still open
    await pipeline.check()
