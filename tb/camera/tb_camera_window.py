# SPDX-License-Identifier: Apache-2.0
"""camera_window against tactile_depth.chip.camera.camera_window: pixels, marks, breaks and faults of the words taken.

tests/camera/test_camera_window.py checks what the model flags and drops.
"""

import random
from collections.abc import Sequence
from typing import Any

import cocotb
from cocotb.triggers import ClockCycles, RisingEdge

from formal.entries import Proof
from tactile_depth.chip.camera.camera_window import FAULTS, LATENCY, Settings, camera_window
from tactile_depth.chip.video.frame_guard import Word
from tb.axis import BREAKS, SILENT, AxisSource, broken, positions, profile, spoiled, video
from tb.cases import on_bench
from tb.pins import by_name
from tb.stream import MANY, REGRESS, parameters, parametrize, start_clock
from tb.structures import ICARUS, VERILATOR, Mutants, Structure


def built(width: int, height: int, words: int, pairs: int, count_width: int, **runs: Any) -> Structure:
    """With few bits for columns and rows, small pictures reach every bit."""
    window = {"WindowColumns": width, "WindowRows": height, "CountWidth": count_width}
    return Structure({**window, "WordsPerPixel": words, "PixelPairs": pairs}, **runs)


STRUCTURES = (
    built(4, 3, 1, 0, 13, on=VERILATOR),
    built(4, 3, 1, 0, 5, on=ICARUS, mutants=ICARUS),
    built(3, 2, 2, 1, 5, on=ICARUS, mutants=ICARUS),
    built(2, 2, 1, 1, 13),
    built(5, 4, 2, 0, 13),
    built(
        3,
        2,
        2,
        1,
        13,
    ),
)
PROTOCOL = {
    "counts": "live & ~reset",
    "out_data out_inside out_odd_row out_odd_column": "counts & out_valid",
    "out_row_start out_frame_start": "counts & out_valid & out_inside",
}
MUTANTS = Mutants(repeats=2)
PROOFS = tuple(
    Proof(
        "rows and columns are only counted and compared",
        {"WordsPerPixel": words, "PixelPairs": pairs},
    )
    for words, pairs in ((1, 0), (1, 1))
)


KINDS = [kind for kind in BREAKS if kind not in SILENT]
STALLS = {"none": ("none", "none"), "gaps": ("random", "none"), "both": ("random", "random")}
SETTINGS = ("columns", "rows", "window_x", "window_y")
LONG = 30  # columns or rows of the largest pictures


class Bench:
    def __init__(self, dut: Any, stalls: str = "none") -> None:
        self.dut, self.read = dut, by_name(dut)
        offers, enabled = STALLS[stalls]
        names = ("WindowColumns", "WindowRows", "WordsPerPixel", "PixelPairs", "CountWidth")
        self.width, self.height, self.words, pairs, count_width = parameters(dut, *names)
        self.pairs, self.largest = bool(pairs), (1 << count_width) - 1
        self.random = random.Random(cocotb.RANDOM_SEED)
        dut.rst.value, dut.en.value = 1, 1
        self.source = AxisSource(dut, "s", offers=profile(offers, 1))
        self.enabled = profile(enabled, 2)
        self.forget()

    def forget(self) -> None:
        self.taken: list[Any] = []  # word and settings
        self.clocks: list[int] = []  # cycle of each word, counted with en
        self.out: list[Any] = []
        self.faults: list[Any] = []

    def use(self, settings: Settings) -> None:
        """Set the size and the window of the next picture."""
        self.settings = settings
        for name, value in zip(SETTINGS, settings, strict=True):
            getattr(self.dut, name).value = value

    def any_settings(self) -> Settings:
        """Return random settings: a window at the edges of a picture or anywhere in it; one side may be long."""
        columns = self.width + self.random.choice((0, 1, 2, 5))
        rows = self.height + self.random.choice((0, 1, 3))
        match self.random.randrange(4):
            case 0:
                columns = self.random.randint(self.width, LONG)
            case 1:
                rows = self.random.randint(self.height, LONG)
        columns += columns % 2 if self.pairs else 0
        x, y = self.random.randint(0, columns - self.width), self.random.randint(0, rows - self.height)
        return Settings(columns, rows, x, y)

    async def start(self) -> None:
        self.use(self.any_settings())
        start_clock(self.dut.clk)
        cocotb.start_soon(self.enable())
        cocotb.start_soon(self.watch())
        await self.reset(3)

    async def enable(self) -> None:
        driven, edge = None, RisingEdge(self.dut.clk)
        while True:
            enabled = int(next(self.enabled))
            if enabled != driven:  # a write costs more than a read
                self.dut.en.value = driven = enabled
            await edge

    async def watch(self) -> None:
        read, edge, clock, before = self.read, RisingEdge(self.dut.clk), 0, None
        while True:
            await edge
            settings = Settings(*map(read, SETTINGS))
            if not read("rst"):
                faults = [name for name in FAULTS if read(name)]
                assert read("en") or not faults, f"{faults} while en is low: would count more than once"
                assert len(faults) < 2, f"{faults} at once"
                self.faults += faults
                if read("en"):
                    clock += 1
                    self.step(clock, settings if before is None else before)
                else:
                    assert not read("s_ready")
            before = settings

    def step(self, clock: int, settings: Settings) -> None:
        read = self.read
        valid, abort = read("out_valid"), read("out_abort")
        assert not (valid and abort)
        if abort:
            self.out.append(None)
        if valid:
            marks = [read(f"out_{name}") for name in ("odd_row", "odd_column", "inside")]
            starts = [read(f"out_{name}") for name in ("row_start", "frame_start")] if marks[2] else []
            self.out.append((clock - LATENCY, read("out_data"), *marks, *starts))
        if read("s_valid") and read("s_ready"):
            self.taken.append((Word(read("s_data"), read("s_last"), read("s_user")), settings))
            self.clocks.append(clock)

    async def reset(self, clocks: int) -> None:
        self.source.abort()
        self.dut.rst.value = 1
        await ClockCycles(self.dut.clk, clocks)
        self.dut.rst.value = 0
        await RisingEdge(self.dut.clk)
        self.forget()

    def picture(self) -> list[Word]:
        columns, rows = self.settings.columns * self.words, self.settings.rows
        return video((self.random.getrandbits(24) for _ in range(rows * columns)), columns)

    async def check(self, what: Any) -> Any:
        await ClockCycles(self.dut.clk, 20)
        want = camera_window(self.taken, (self.width, self.height), self.words, self.pairs)
        expected: list[Any] = []
        for position, pixel in want.out:
            if pixel is None:
                expected.append(None)
                continue
            starts = [int(pixel.row_start), int(pixel.frame_start)] if pixel.inside else []
            marks = pixel.row % 2, pixel.column % 2, int(pixel.inside)
            expected.append((self.clocks[position], pixel.data, *marks, *starts))
        assert self.faults == [name for _, name in want.faults], f"{what}: faults"
        assert self.out == expected, f"{what}: pixels and breaks"
        return want

    def places(self, kind: str) -> Sequence[int]:
        return positions(kind, self.settings.rows, self.settings.columns * self.words)


@on_bench(Bench, milliseconds=5)
@parametrize(kind=KINDS, stalls=list(STALLS))
async def broken_pictures(bench: Bench, kind: str, stalls: str) -> None:
    """Send a good picture, a broken one and a good one, for every position of the break; with stalls for a few
    positions."""
    bench.use(Settings(bench.width + 2, bench.height + 2, 1, 1))
    await ClockCycles(bench.dut.clk, 2)
    places = bench.places(kind)
    stride = 1 if REGRESS or stalls == "none" else min(7, len(places))
    for position in places[bench.random.randrange(stride) :: stride]:
        wrong = broken(bench.picture(), kind, position, bench.settings.columns * bench.words)
        await bench.source.send([*bench.picture(), *wrong, *bench.picture()])
        await bench.check(f"{kind} at {position}")
        bench.forget()


@on_bench(Bench, milliseconds=5)
@parametrize(stalls=list(STALLS))
async def windows_anywhere(bench: Bench) -> None:
    """Change the settings before, at the start of and within pictures; some windows exceed the picture."""
    outside = 0
    for _ in range(20 * MANY):
        settings = bench.any_settings()
        if bench.random.random() < 0.4:
            field = bench.random.choice(Settings._fields)
            limit = {"columns": settings.x + bench.width, "rows": settings.y + bench.height}.get(field, 0)
            settings = settings._replace(
                **{field: bench.random.choice((limit, max(limit - 1, 0), limit + 1, bench.largest))}
            )
        size = settings if max(settings.columns, settings.rows) < bench.largest else bench.settings
        bench.use(settings)
        bench.settings = size
        await ClockCycles(bench.dut.clk, bench.random.choice((0, 1, 2)))
        await bench.source.send(bench.picture())
        outside += "window_outside" in bench.faults
        await bench.check(settings)
        await bench.reset(1)
    assert outside, "the test is void: every window lies inside the picture"


@on_bench(Bench, milliseconds=5)
async def resets(bench: Bench) -> None:
    """Reset at every position of a picture; the next picture is right."""
    bench.use(Settings(bench.width + 1 + bench.pairs, bench.height + 1, 1, 0))
    for position in range(bench.settings.columns * bench.settings.rows * bench.words):
        words = bench.picture()
        if position % 3 == 0:
            words[position] = words[position]._replace(last=1 - words[position].last)
        cocotb.start_soon(bench.source.send(words))
        await ClockCycles(bench.dut.clk, position + 2)
        await bench.reset(1 + position % 2)
        await bench.source.send(bench.picture())
        assert not (await bench.check(f"reset at {position}")).faults


@on_bench(Bench, milliseconds=20)
@parametrize(stalls=list(STALLS))
async def random_streams(bench: Bench) -> None:
    """Send random streams: good and broken pictures, several faults in one, stray words, flipped marks."""
    rng, flagged = bench.random, set()
    for index in range(30 * MANY):
        if index % 10 == 0:
            bench.use(bench.any_settings())
        words = spoiled(bench.picture(), rng, 5) or bench.picture()
        await bench.source.send(words)
        if index % 10 == 9:
            flagged |= {name for _, name in (await bench.check(f"random stream {index}")).faults}
            await bench.reset(1)
    assert flagged >= {"row_short", "row_long", "start_early", "start_missing"}, (
        f"the test is void: it reached only {flagged}"
    )
