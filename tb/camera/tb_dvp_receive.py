# SPDX-License-Identifier: Apache-2.0
"""dvp_receive against tactile_depth.chip.camera.dvp_receive, at every edge of both clocks: ratios, stalls, resets."""

import itertools
import random
from collections.abc import Iterable, Iterator
from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import ClockCycles, RisingEdge

from formal.entries import Proof
from tactile_depth.chip.camera.dvp_receive import IDLE, Beat, DvpReceive, Pins, camera_pins
from tactile_depth.chip.common.td_async_fifo import AsyncFifo
from tb.axis import AxisMonitor, AxisSink, profile
from tb.pins import Driver
from tb.stream import REGRESS, parameters, parametrize, sample
from tb.structures import BOTH, ICARUS, of_parameters
from tb.two_clocks import RATIOS, run_clock, watch

built = of_parameters("FifoLog2")
STRUCTURES = (
    built(4, on=BOTH),
    built(3, on=ICARUS, mutants=ICARUS),
)
REFUSED = {"FifoLog2_must_be_at_least_3_or_nearly_equal_clocks_lose_every_frame": "FifoLog2=2"}
PROTOCOL = {"counts": "live", "m_axis_tdata m_axis_tlast m_axis_tuser": "live & m_axis_tvalid"}
PROOFS = (
    Proof(
        "the widths in use; td_async_fifo is proven by itself",
        free=("write_ready", "read_valid", "word"),
    ),
)


ROWS, BYTES = 3, 12
NEARLY = ("equal", "half", "a_bit_slow", "a_bit_fast", "three_to_2")  # so near that the queue takes a frame's backlog
FAST_ENOUGH = ("equal", "half", "a_bit_fast", "three_to_2", "camera_24", "far_faster")  # clk as fast as pclk
CAMERA = ("vsync", "href", "data")
SYSTEM = ("rst", "m_axis_tready", "m_axis_tvalid", "m_axis_tdata", "m_axis_tlast", "m_axis_tuser", "frames_lost")


class Bench:
    """Both clocks, the sink, and a record of the pins; `check` compares the record with the model."""

    def __init__(self, dut: Any) -> None:
        self.dut, self.drive = dut, Driver(dut)
        self.random = random.Random(cocotb.RANDOM_SEED)
        self.events: list[Any] = []
        self.lost: list[int] = []

    async def start(self, ratio: str, accepts: Iterable[bool]) -> None:
        """Start the clocks, empty the queue, and reset."""
        dut = self.dut
        dut.rst.value = 1
        self.drive(vsync=0, href=0, data=0)
        for seed, (clock, period) in enumerate(zip((dut.pclk, dut.clk), RATIOS[ratio], strict=True)):
            cocotb.start_soon(run_clock(clock, period, seed))
        (fifo_log2,) = parameters(dut, "FifoLog2")
        self.sink = AxisSink(dut, "m_axis", prefix="t")
        await self.settle(fifo_log2)
        self.model = DvpReceive(AsyncFifo(1 << fifo_log2))
        cocotb.start_soon(watch(dut.pclk, [getattr(dut, pin) for pin in CAMERA], self.events, "camera"))
        cocotb.start_soon(watch(dut.clk, [getattr(dut, pin) for pin in SYSTEM], self.events, "system"))
        self.out = AxisMonitor(dut, "m_axis", ("data", "last", "user"), prefix="t")
        self.sink.stall(accepts)
        dut.rst.value = 0
        await RisingEdge(dut.clk)

    async def settle(self, fifo_log2: int) -> None:
        """Begin and end a frame, so that the side of the camera waits for the next one; reset the words that have
        crossed."""
        await self.play([Pins(True, False, 0)] * 2)
        await self.play([IDLE] * 4)
        await ClockCycles(self.dut.clk, 8 + (1 << fifo_log2))
        await ClockCycles(self.dut.pclk, 4)
        await self.play([Pins(True, False, 0)] * 2)
        await self.play([IDLE] * 4)
        await ClockCycles(self.dut.clk, 8)
        await ClockCycles(self.dut.pclk, 4)

    async def play(self, pins: Iterable[Pins]) -> None:
        """Drive the pins of the camera, one entry in each cycle of pclk."""
        edge = RisingEdge(self.dut.pclk)
        for vsync, href, data in pins:
            self.drive(vsync=vsync, href=href, data=data)
            await edge
        self.drive(vsync=0, href=0)

    async def end(self) -> None:
        """Wait until the queue is empty, and check every edge."""
        self.sink.stall(itertools.repeat(True))
        (fifo_log2,) = parameters(self.dut, "FifoLog2")
        await ClockCycles(self.dut.pclk, 6)
        await ClockCycles(self.dut.clk, 10 + (1 << fifo_log2))
        self.check()

    def check(self) -> None:
        """Compare the outputs before each edge with the model, which takes the inputs before that edge."""
        model = self.model
        model.receiving = True  # as `settle` leaves it
        for time, edges in itertools.groupby(self.events, key=lambda event: event[0]):
            pins = {side: values for _, side, values in edges}
            camera, sink = pins.get("camera"), None
            if "system" in pins:
                at = pins["system"]
                sink = bool(at["rst"]), bool(at["m_axis_tready"])
                beat_at_pins = None
                if at["m_axis_tvalid"]:
                    flags = bool(at["m_axis_tlast"]), bool(at["m_axis_tuser"])
                    beat_at_pins = Beat(int(at["m_axis_tdata"]), *flags)
                assert beat_at_pins == model.beat, f"at {time} ps"
                assert int(at["frames_lost"]) == model.frames_lost, f"frames_lost at {time} ps"
                self.lost += [model.frames_lost] * (model.frames_lost > 0)
            sampled = Pins(bool(camera["vsync"]), bool(camera["href"]), int(camera["data"])) if camera else None
            model.edges(sampled, sink)

    def frames(self, count: int) -> np.ndarray:
        """Return random pictures (count, ROWS, BYTES) of bytes."""
        return np.frombuffer(self.random.randbytes(count * ROWS * BYTES), np.uint8).reshape(count, ROWS, BYTES)


def beats(frame: np.ndarray) -> list[tuple[int, int, int]]:
    """Return the beats of a whole frame."""
    ends = np.arange(frame.size) % BYTES == BYTES - 1
    return [(byte, int(end), int(index == 0)) for index, (byte, end) in enumerate(zip(frame.flat, ends, strict=True))]


def stalls(first: int, length: int) -> Iterator[bool]:
    """Yield the ready of a sink that stalls once, for `length` cycles after `first` cycles."""
    return itertools.chain([True] * first, [False] * length, itertools.repeat(True))


@cocotb.test(timeout_time=2, timeout_unit="ms")
@parametrize(ratio=list(RATIOS), accepts=sample(["none", "one_in_4", "random"]))
async def whole_frames(dut: Any, ratio: str, accepts: str) -> None:
    """Send frames: every byte arrives if the sink is fast enough; otherwise frames are whole, or cut short and
    counted."""
    bench = Bench(dut)
    await bench.start(ratio, profile(accepts))
    frames = bench.frames(4)
    for frame in frames:
        await bench.play(camera_pins(frame, 3, 40))
    await bench.end()
    if accepts == "none" and ratio in FAST_ENOUGH:
        assert bench.out.words == [beat for frame in frames for beat in beats(frame)]
        assert not bench.lost


@cocotb.test(timeout_time=2, timeout_unit="ms")
@parametrize(ratio=sample(list(NEARLY)))
async def frames_lost(dut: Any, ratio: str) -> None:
    """Stall anywhere in a frame: only that frame is lost, it is counted once, and only its beginning leaves."""
    fifo_depth = 1 << parameters(dut, "FifoLog2")[0]
    pclk, clk = RATIOS[ratio]
    frame_clocks = (2 + 40 + ROWS * (BYTES + 3)) * pclk // clk
    bench = Bench(dut)
    await bench.start(ratio, itertools.repeat(True))
    steps = range(0, frame_clocks, 1 if REGRESS else 15)
    for first in steps:
        frames = bench.frames(3)
        before, lost, after = (beats(frame) for frame in frames)
        bench.out.forget()
        await bench.play(camera_pins(frames[0], 3, 40))
        bench.sink.stall(stalls(first, (fifo_depth + 4 * BYTES) * pclk // clk))
        await bench.play(camera_pins(frames[1], 3, 40))
        await bench.play([IDLE] * 90)
        await bench.play(camera_pins(frames[2], 3, 40))
        await bench.play([IDLE] * 40)
        kept = bench.out.words[len(before) : len(bench.out.words) - len(after)]
        assert bench.out.words == [*before, *lost[: len(kept)], *after], f"stalled after {first} clocks"
    await bench.end()
    assert 0 < len(bench.lost) <= len(steps)
    assert set(bench.lost) == {1}


@cocotb.test(timeout_time=2, timeout_unit="ms")
@parametrize(ratio=sample(["equal", "half", "camera_24", "twice"]))
async def anything(dut: Any, ratio: str) -> None:
    """Drive the pins at random, with vsync inside a row and for one cycle too; the sink stalls at random."""
    bench = Bench(dut)
    chance = bench.random
    runs = (([True] * chance.randint(1, 60)) + [False] * chance.randint(1, 40) for _ in itertools.repeat(None))
    await bench.start(ratio, itertools.chain.from_iterable(runs))
    for _ in range(150 if REGRESS else 60):
        vsync = [Pins(True, chance.random() < 0.2, chance.getrandbits(8)) for _ in range(chance.choice((0, 1, 2, 6)))]
        await bench.play(vsync)
        for _ in range(chance.randint(0, 3)):
            href = [Pins(False, True, chance.getrandbits(8)) for _ in range(chance.choice((1, 2, 9, 20)))]
            await bench.play([*[Pins(False, False, 255)] * chance.randint(0, 4), *href])
    await bench.end()


@cocotb.test(timeout_time=2, timeout_unit="ms")
@parametrize(count=[2, 5, 254, 255, 300])
async def many_lost(dut: Any, count: int) -> None:
    """Send frames that the sink never takes, and count them up to 255."""
    bench = Bench(dut)
    await bench.start("equal", itertools.repeat(True))
    frames = bench.frames(2)
    bench.sink.stall(itertools.repeat(False))
    await bench.play(camera_pins(frames[0], 3, 4))
    for _ in range(count - 1):
        await bench.play([Pins(True, False, 0), IDLE, Pins(False, True, 1), IDLE])
    bench.sink.stall(itertools.repeat(True))
    await bench.play([IDLE] * 40)
    await bench.play(camera_pins(frames[1], 3, 4))
    await bench.end()
    assert bench.lost == [min(count, 255)]
    assert bench.out.words[-frames[1].size :] == beats(frames[1])


@cocotb.test(timeout_time=2, timeout_unit="ms")
@parametrize(clocks=[1, 2, 5])
async def resets(dut: Any, clocks: int) -> None:
    """Reset at any time in a frame: nothing of it leaves afterwards, and the next frame is whole."""
    bench = Bench(dut)
    await bench.start("equal", itertools.repeat(True))
    for phase in range(0, 90, 3 if REGRESS else 11):
        frames = bench.frames(2)
        playing = cocotb.start_soon(bench.play(camera_pins(frames[0], 3, 20)))
        await ClockCycles(dut.clk, phase)
        dut.rst.value = 1
        await ClockCycles(dut.clk, clocks)
        dut.rst.value = 0
        await playing
        await bench.play([IDLE] * 30)
        bench.out.forget()
        await bench.play(camera_pins(frames[1], 3, 20))
        await bench.play([IDLE] * 30)
        assert bench.out.words == beats(frames[1]), f"reset after {phase} clocks"
    await bench.end()
