# SPDX-License-Identifier: Apache-2.0
"""frame_guard against tactile_depth.chip.video.frame_guard: frames, marks and faults of the words seen at the input.

tests/video/test_frame_guard.py checks the frames and faults of the model.
"""

import random
from itertools import chain, repeat
from typing import Any

import cocotb
from cocotb.triggers import ClockCycles, RisingEdge

from formal.entries import Proof
from tactile_depth.chip.video.frame_guard import FAULTS, frame_guard
from tb.axis import BREAKS, SILENT, AxisMonitor, AxisSource, broken, faults_of, positions, profile, spoiled, video
from tb.cases import on_bench
from tb.pins import by_name, unsigned
from tb.stream import REGRESS, parameters, parametrize, raster, start_clock
from tb.structures import ICARUS, VERILATOR, Mutants, of_parameters

built = of_parameters("Rows Columns")
STRUCTURES = (
    built(8, 2, on=VERILATOR),
    built(3, 4, on=ICARUS, mutants=ICARUS),
    built(
        4,
        8,
    ),
)
PROTOCOL = {
    "counts": "live & ~reset",
    "out_valid out_frame_start out_frame_end": "counts & en",
    "out_data out_position": "counts & en & out_valid",
    "out_bad": "counts & en & out_valid & out_frame_end",
}
MUTANTS = Mutants(outside=("silence",))
PROOFS = tuple(
    Proof(
        "rows and columns are only counted; a count that is no power of two, and one that is",
        {"Rows": rows, "Columns": columns},
    )
    for rows, columns in ((3, 4), (4, 2))
)


TIMEOUT = 5
RANDOM_FRAMES = 60


class Collector:
    """Collect frames as (pixels, bad) and faults by name; check the position of every flag."""

    def __init__(self, dut: Any) -> None:
        self.dut, self.read = dut, by_name(dut)
        self.rows, self.columns = parameters(dut, "Rows", "Columns")
        self.positions = raster(self.rows, self.columns)
        self.frames: list[Any] = []
        self.faults: list[Any] = []
        self.open: list[Any] = []
        cocotb.start_soon(self.run())

    async def run(self) -> None:
        read, edge = self.read, RisingEdge(self.dut.clk)
        while True:
            await edge
            if read("rst"):
                continue
            bits = read("faults")
            faults = [name for bit, name in enumerate(FAULTS) if bits >> bit & 1]
            assert read("en") or not faults, f"{faults} while en is low: would count more than once"
            self.faults += faults
            if read("en"):
                self.step()

    def step(self) -> None:
        read, place = self.read, len(self.open)
        if not read("out_valid"):
            assert not read("out_frame_end")
            assert not read("out_frame_start")
            return
        self.open.append(read("out_data"))
        assert read("out_position") == self.positions[place], f"out_position at pixel {place}"
        flags = {
            "out_frame_start": place == 0,
            "out_frame_end": place == self.rows * self.columns - 1,
        }
        for name, want in flags.items():
            assert read(name) == want, f"{name} at pixel {place}"
        if flags["out_frame_end"]:
            self.frames.append((tuple(self.open), bool(read("out_bad"))))
            self.open = []


class Bench:
    def __init__(self, dut: Any, stalls: str = "none") -> None:
        offers, enabled = STALLS[stalls]
        self.dut = dut
        self.rows, self.columns = parameters(dut, "Rows", "Columns")
        self.random = random.Random(cocotb.RANDOM_SEED)
        dut.rst.value, dut.en.value, dut.timeout.value = 1, 1, 0
        self.source = AxisSource(dut, "s", offers=profile(offers, 1))
        self.monitor = AxisMonitor(dut, "s", silence="en")
        self.collector = Collector(dut)
        self.enabled = profile(enabled, 2)

    async def start(self, timeout: int = 0) -> None:
        start_clock(self.dut.clk)
        cocotb.start_soon(self.enable())
        await self.reset(3, timeout)

    async def enable(self) -> None:
        driven, edge = None, RisingEdge(self.dut.clk)
        while True:
            enabled = int(next(self.enabled))
            if enabled != driven:  # a write costs more than a read
                self.dut.en.value = driven = enabled
            await edge

    async def reset(self, clocks: int, timeout: int | None = None) -> None:
        self.source.abort()
        if timeout is not None:
            self.timeout = self.dut.timeout.value = timeout
        self.dut.rst.value = 1
        await ClockCycles(self.dut.clk, clocks)
        self.dut.rst.value = 0
        await RisingEdge(self.dut.clk)  # AXI: the first edge out of reset comes before the first word
        self.forget()

    def forget(self) -> None:
        self.monitor.forget()
        self.collector.frames, self.collector.faults, self.collector.open = [], [], []

    def frame(self) -> Any:
        pixels = (self.random.getrandbits(24) for _ in range(self.rows * self.columns))
        return video(pixels, self.columns)

    async def check(self, what: Any) -> Any:
        """Wait for the end of the filler, compare with the model, and clear the records. The source must be idle."""
        moved, en, edge = 0, unsigned(self.dut.en), RisingEdge(self.dut.clk)
        while moved < self.rows * self.columns + 2:
            await edge
            moved += en()
        want = frame_guard(self.monitor.words, self.rows, self.columns, self.timeout)
        got = self.collector
        assert got.faults == want.faults, f"{what}: faults {got.faults}, expected {want.faults}"
        marks = [frame.bad for frame in want.frames]
        assert [bad for _, bad in got.frames] == marks, f"{what}: marks, expected {marks}"
        for index, ((pixels, _), frame) in enumerate(zip(got.frames, want.frames, strict=True)):
            assert pixels == frame.pixels, f"{what}: pixels of frame {index}"
        assert got.open == want.open, f"{what}: pixels of the last, incomplete frame"
        return want

    def places(self, fault: str) -> Any:
        return positions(fault, self.rows, self.columns)


STALLS = {
    "none": ("none", "none"),
    "gaps": ("random", "none"),
    "en": ("none", "random"),
    "both": ("random",) * 2,
}


@on_bench(Bench)
async def long_silences(bench: Bench) -> None:
    """Time out with every bit of the timeout and of the counter, which is set to a value near its end to save time."""
    powers = [1 << bit for bit in range(3, 32)]
    others = [power - 1 for power in (*powers, 1 << 32)] + [bench.random.getrandbits(32) | 8 for _ in range(10)]
    for timeout in powers + others:
        await bench.reset(1, timeout)
        await bench.source.send(bench.frame()[:3])
        await ClockCycles(bench.dut.clk, 2)
        bench.dut.silence.value = timeout - 3
        await ClockCycles(bench.dut.clk, 4)
        assert not bench.collector.faults, f"timed out before {timeout} cycles"
        await ClockCycles(bench.dut.clk, 1)
        assert bench.collector.faults == ["timed_out"], f"not timed out after {timeout} cycles"


@cocotb.test(timeout_time=1, timeout_unit="ms")
@parametrize(kind=list(BREAKS), stalls=list(STALLS))
async def faults(dut: Any, kind: str, stalls: str) -> None:
    """Send a good frame, a broken one and a good one, for every position of the break; with stalls for a third of
    them."""
    bench = Bench(dut, stalls)
    timeout = TIMEOUT if kind in SILENT else 0
    await bench.start(timeout)
    places = bench.places(kind)
    stride = 1 if REGRESS or stalls == "none" else min(3, len(places))
    for position in places[bench.random.randrange(stride) :: stride]:
        wrong = broken(bench.frame(), kind, position, bench.columns, timeout + (kind != "waited"))
        await bench.source.send([*bench.frame(), *wrong, *bench.frame()])
        want = await bench.check(f"{kind} at {position}")
        if stalls == "none":
            faults = faults_of(kind, position, bench.columns)
            assert want.faults == list(faults), f"not the stream it was meant to be: {want.faults} at {position}"
        bench.forget()


@on_bench(Bench)
@parametrize(stalls=list(STALLS))
async def words_before_the_first_frame(bench: Bench) -> None:
    """Send any number of words before a frame: they are dropped as one fault, and the frame is right."""
    for count in range(1, 2 * bench.columns + 2):
        await bench.reset(1)
        before = [word._replace(user=0) for word in (bench.frame() * 2)[:count]]
        await bench.source.send([*before, *bench.frame()])
        want = await bench.check(f"{count} words before")
        assert want.faults == ["start_missing"]
        assert [frame.bad for frame in want.frames] == [False]


@on_bench(Bench)
async def silence(bench: Bench) -> None:
    """Pause at every position for `timeout` cycles and for one more. With a timeout of 0, or between frames, wait for
    ever."""
    for timeout in (0, 1, TIMEOUT):
        await bench.reset(1, timeout)
        for position in bench.places("timed_out"):
            for clocks in {1, max(timeout, 1), timeout + 1, timeout + 2, 40}:
                frame = bench.frame()
                pause = [None] * clocks
                await bench.source.send([*frame[:position], *pause, *frame[position:], *pause, *bench.frame()])
                want = await bench.check(f"{clocks} silent clocks at {position}, timeout {timeout}")
                given_up = 0 < timeout < clocks
                assert want.faults == ["timed_out"] * given_up
                bench.forget()


@cocotb.test(timeout_time=1, timeout_unit="ms")
async def silence_without_movement(dut: Any) -> None:
    """Pause with en low, which is not silence; a timeout written during a silence counts from its beginning."""
    bench = Bench(dut)
    await bench.start(TIMEOUT)
    frame = bench.frame()
    await bench.source.send(frame[:3])
    bench.enabled = chain(repeat(False, 50), repeat(True))
    await ClockCycles(dut.clk, 45)
    assert not bench.collector.faults
    await ClockCycles(dut.clk, 8 + TIMEOUT)
    assert bench.collector.faults == ["timed_out"]

    await bench.reset(1, 0)
    await bench.source.send(frame[:3])
    await ClockCycles(dut.clk, 30)
    assert not bench.collector.faults
    dut.timeout.value = 20
    await ClockCycles(dut.clk, 2)
    assert bench.collector.faults == ["timed_out"]


@on_bench(Bench)
@parametrize(clocks=[1, 2, 16])
async def resets(bench: Bench, clocks: Any) -> None:
    """Reset at every position of a good frame and of the filler of a broken one; the next frame is right."""
    for position in bench.places("start_early"):
        for fault in (None, "row_short"):
            words = bench.frame()
            words = words if fault is None else broken(words, fault, 0, bench.columns)
            cocotb.start_soon(bench.source.send(words))
            await ClockCycles(bench.dut.clk, position + 1)
            await bench.reset(clocks)
            await bench.source.send(bench.frame())
            want = await bench.check(f"reset of {clocks} clocks at {position}, {fault}")
            assert want.faults == []
            assert len(want.frames) == 1


@cocotb.test(timeout_time=20, timeout_unit="ms")
@parametrize(timeout=[0, 1, TIMEOUT], stalls=list(STALLS))
async def random_streams(dut: Any, timeout: int, stalls: str) -> None:
    """Send random streams: good and broken frames, several faults in one, stray words, flipped marks, long silences."""
    bench = Bench(dut, stalls)
    await bench.start(timeout)
    rng, faults_reached = bench.random, set()
    for index in range(RANDOM_FRAMES):
        words = spoiled(bench.frame(), rng, 2 * bench.columns)
        silent = [None] * rng.choice((0, 0, 0, 1, timeout, timeout + 1, 3 * timeout + 2))
        place = rng.randrange(len(words) + 1)
        await bench.source.send([*words[:place], *silent, *words[place:]])
        if index % 10 == 9:
            await bench.source.send(bench.frame())
            faults_reached |= set((await bench.check(f"random stream {index}")).faults)
            await bench.reset(1)
    if stalls in ("none", "en"):  # with gaps most frames time out before another fault can occur
        assert faults_reached >= set(FAULTS) - ({"timed_out"} if not timeout else set()), (
            f"the test is void: it reached only {faults_reached}"
        )
