# SPDX-License-Identifier: Apache-2.0
"""camera_front_end against its model: blanking, gaps and stalls, broken pictures, changing windows, resets.

The output goes through the model of frame_guard, which follows the core: each broken picture must become one broken
frame.
"""

import itertools
import math
import random
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import ClockCycles, RisingEdge

from tactile_depth.chip.camera.camera_front_end import (
    SETTINGS,
    camera_front_end,
    camera_front_end_parameters,
    camera_settings,
)
from tactile_depth.chip.camera.camera_front_end import latency as camera_front_end_latency
from tactile_depth.chip.camera.camera_window import FAULTS, Settings, camera_window
from tactile_depth.chip.camera_configuration import FORMATS, PHASES, CameraConfiguration
from tactile_depth.chip.common.td_frame_size import FrameSize
from tactile_depth.chip.video.frame_guard import Word, frame_guard
from tb import structs
from tb.axis import BREAKS, SILENT, AxisMonitor, AxisSink, AxisSource, broken, positions, profile
from tb.camera.slots import camera_words, pack_settings
from tb.cases import on_bench
from tb.pins import unsigned
from tb.settings import RUN
from tb.stream import MANY, at_every_edge, parametrize, sample, start_clock
from tb.structures import ICARUS, VERILATOR, Mutants, Structure

GRID = (4, 8)


def arguments(form: str, picture: tuple[int, int], **choices: Any) -> dict[str, Any]:
    return {"picture": picture, "grid": GRID, "pixel_format": form, **choices}


# Camera pixels per grid pixel. A picture of YUYV has an even number of columns.
RATIOS = [Fraction(*ratio) for ratio in ((1, 1), (5, 4), (3, 2), (2, 1), (9, 4), (11, 4), (15, 4), (23, 4), (8, 1))]
COLOURED = [form for form in FORMATS if not FORMATS[form].bayer]
PATTERNS = [(form, phase) for form in FORMATS if FORMATS[form].bayer for phase in PHASES]


def every_format_phase_and_ratio() -> list[dict[str, Any]]:
    """Return structures: each format, with each phase and order of bytes or bits, and the ratios in turn."""
    sizes = [(math.ceil(GRID[0] * ratio) + 1, int(GRID[1] * ratio)) for ratio in RATIOS]
    pictures = itertools.cycle(sizes)
    coloured = [arguments(form, next(pictures)) for form in COLOURED for _ in range(2)]
    pictures = itertools.cycle(sizes[RATIOS.index(Fraction(2)) :])
    patterns = [arguments(form, next(pictures), phase=phase) for form, phase in PATTERNS]
    return [*coloured, *patterns]


def built(choices: dict[str, Any], **runs: Any) -> Structure:
    camera = CameraConfiguration(**choices)
    return Structure(camera_front_end_parameters(camera), device={"camera": choices}, **runs)


STRUCTURES = (
    built(arguments("raw10", (17, 34), phase="gbrg"), on=VERILATOR),
    built(arguments("raw8", (9, 17), phase="grbg"), on=ICARUS, mutants=ICARUS),
    built(arguments("yuyv_bytes", (10, 16)), on=VERILATOR, mutants=ICARUS),
    built(arguments("rgb888", (4, 9)), on=ICARUS),
    *(built(choices) for choices in every_format_phase_and_ratio()),
    built(arguments("yuyv", (7, 18), window=[3, 1, 10, 5])),
    built(arguments("yuyv", (7, 18), window=[4, 1, 9, 5])),
)
MUTANTS = Mutants(repeats=2, flat=False)
NO_PROOF = "a chain of proven cores, each of which takes what the one before it sends"


KINDS = [kind for kind in BREAKS if kind not in SILENT]
SETTLE = 60


class Bench:
    def __init__(self, dut: Any, offers: str = "none", stalls: str = "none") -> None:
        self.dut = dut
        self.camera = CameraConfiguration(**RUN.device["camera"])
        self.random = random.Random(cocotb.RANDOM_SEED)
        self.rng = np.random.default_rng(cocotb.RANDOM_SEED)
        dut.rst.value = 1
        self.source = AxisSource(dut, "s_axis", prefix="t", offers=profile(offers, 1))
        self.sink = AxisSink(dut, "m_axis", prefix="t", accepts=profile(stalls, 2))
        self.came = AxisMonitor(dut, "s_axis", prefix="t")
        self.left = AxisMonitor(dut, "m_axis", prefix="t")
        self.faults: list[str] = []

    async def start(self) -> None:
        self.use(self.camera)
        start_clock(self.dut.clk)
        at_every_edge(self.dut.clk, self.watch())
        await self.reset(3)

    def use(self, camera: CameraConfiguration) -> None:
        self.camera = camera
        self.dut.settings.value = pack_settings(camera_settings(camera))

    def watch(self) -> Iterator[None]:
        rst, faults = unsigned(self.dut.rst), unsigned(self.dut.faults)
        while True:
            yield
            if not rst() and (bits := faults()):
                self.faults += [name for place, name in enumerate(FAULTS) if bits >> place & 1]

    async def reset(self, clocks: int) -> None:
        self.source.abort()
        self.dut.rst.value = 1
        await ClockCycles(self.dut.clk, clocks)
        self.dut.rst.value = 0
        await RisingEdge(self.dut.clk)
        self.forget()

    def forget(self) -> None:
        self.came.forget()
        self.left.forget()
        self.faults.clear()

    def check_levels(self, **others: int) -> None:
        """Compare the levels with what has come: pictures of the size of the settings, but for `others`."""
        rows, columns = self.camera.picture
        whole = {"hunting": 0, "waiting": 0, "arrived_columns": columns, "arrived_rows": rows}
        levels = structs.of(self.dut.levels, "camera_levels_t")
        assert levels == whole | others, f"levels are {levels}"

    def picture(self) -> tuple[list[Word], np.ndarray]:
        """Return the words of a picture, and the frame of the grid."""
        words = self.rng.integers(0, 1 << 24, self.camera.picture)
        return camera_words(words, self.camera), camera_front_end(words, self.camera)

    def blanked(self, words: list[Word]) -> list[Word | None]:
        """Return the words with blanking of random length after each row and before the picture."""
        out: list[Word | None] = [None] * self.random.randrange(20)
        for word in words:
            out += [word, *[None] * (self.random.randrange(9) if word.last else 0)]
        return out

    async def frames(self) -> list[np.ndarray]:
        """Wait until everything has left; return the frames that frame_guard accepts, uint8 (rows, columns, 3)."""
        rows, columns = self.camera.grid
        await ClockCycles(self.dut.clk, SETTLE)
        while self.dut.m_axis_tvalid.value:
            await RisingEdge(self.dut.clk)
        await ClockCycles(self.dut.clk, SETTLE)
        guarded = frame_guard(self.left.words, rows, columns)
        assert len(guarded.faults) == len(self.faults), f"camera: {self.faults}, frame_guard: {guarded.faults}"
        assert not guarded.open
        good = [np.array(frame.pixels) for frame in guarded.frames if not frame.bad]
        return [
            np.stack([frame >> shift & 255 for shift in (16, 0, 8)], -1).reshape(rows, columns, 3) for frame in good
        ]


@on_bench(Bench, milliseconds=20)
@parametrize((("offers", "stalls"), [("none", "none"), ("random", "none"), ("none", "random"), ("long", "long")]))
async def pictures(bench: Bench, stalls: str) -> None:
    """Send pictures: every frame equals the model, and without stalls all have the same latency to their last pixel."""
    want, last = [], []
    bench.check_levels(waiting=1, arrived_columns=0, arrived_rows=0)
    for index in range(MANY + 1):
        words, frame = bench.picture()
        want.append(frame)
        last.append(index * len(words) + bench.camera.last_word)
        await bench.source.send(bench.blanked(words))
        await ClockCycles(bench.dut.clk, bench.random.choice((0, 1, 2)))
    got = await bench.frames()
    np.testing.assert_array_equal(got, want)
    assert not bench.faults
    bench.check_levels()
    if stalls == "none":
        pixels = want[0].size // 3
        out = [bench.left.offered[(index + 1) * pixels - 1] for index in range(len(want))]
        latencies = {after - bench.came.taken[place] for after, place in zip(out, last, strict=True)}
        assert latencies == {camera_front_end_latency(bench.camera)}, latencies


@cocotb.test(timeout_time=20, timeout_unit="ms")
@parametrize(kind=KINDS, stalls=["none", "random"])
async def broken_pictures(dut: Any, kind: str, stalls: str) -> None:
    """Send a good picture, a broken one and a good one: the good ones leave, and the other becomes one broken frame."""
    bench = Bench(dut, stalls, stalls)
    await bench.start()
    columns = bench.camera.picture[1] * bench.camera.words_per_pixel
    places = positions(kind, bench.camera.picture[0], columns)
    for position in sample([places[0], places[1 % len(places)], bench.random.choice(places), places[-1]]):
        (before, first), (wrong, _), (after, second) = (bench.picture() for _ in range(3))
        await bench.source.send([*before, *broken(wrong, kind, position, columns), *after])
        got = await bench.frames()
        np.testing.assert_array_equal(got[0], first, f"{kind} at {position}")
        np.testing.assert_array_equal(got[-1], second, f"{kind} at {position}")
        harmless = not bench.faults or (kind == "start_extra" and position > bench.camera.last_word)
        assert len(got) == 2 + harmless, f"{kind} at {position}: {bench.faults}"
        size = FrameSize(14, bench.camera.words_per_pixel)
        for word in bench.came.words:
            size.take(word.last, word.user)
        bench.check_levels(arrived_rows=size.rows)
        bench.forget()


@on_bench(Bench, milliseconds=20)
async def settings_change_between_pictures(bench: Bench) -> None:
    """Change window, gains and black level between pictures; a window beyond the picture is a fault."""
    built = bench.camera
    rows, columns = built.picture
    _, _, width, height = built.crop
    for _ in range(4 * MANY):
        x, y = bench.random.randint(0, columns - width), bench.random.randint(0, rows - height)
        red, green, blue = (bench.random.randrange(1 << 14) / (1 << 12) for _ in range(3))
        black = bench.random.randrange(1 << bench.camera.bits)
        window = (x, y, width, height)
        black = bench.random.choice((0, black))
        bench.use(replace(built, window=window, gains=(red, green, blue), black_level=black))
        await ClockCycles(bench.dut.clk, 2)
        words, frame = bench.picture()
        await bench.source.send(words)
        np.testing.assert_array_equal(await bench.frames(), [frame])
        bench.forget()
    bench.dut.settings.value = pack_settings({**camera_settings(built), "window_x": columns - width + 1})
    await ClockCycles(bench.dut.clk, 2)
    await bench.source.send(bench.picture()[0])
    assert await bench.frames() == []
    assert bench.faults == ["window_outside"]


@on_bench(Bench, milliseconds=20)
@parametrize(name=["columns", "rows", "window_x", "window_y"])
async def settings_in_every_bit(bench: Bench, name: str) -> None:
    """Set size and place of the window with one bit wrong: the faults are the model's, and with the right settings the
    next picture is right."""
    built, right = bench.camera, camera_settings(bench.camera)
    crop, pairs = built.crop[2:], built.format.is_yuyv
    names = ("columns", "rows", "window_x", "window_y")
    for bit in sample(list(range(SETTINGS[name]))):
        taken: list[tuple[Word, Settings]] = []
        for settings in (right | {name: right[name] ^ 1 << bit}, right):
            bench.dut.settings.value = pack_settings(settings)
            await ClockCycles(bench.dut.clk, 2)
            words, frame = bench.picture()
            await bench.source.send(words)
            await ClockCycles(bench.dut.clk, SETTLE)
            taken += [(word, Settings(*(settings[each] for each in names))) for word in words]
        np.testing.assert_array_equal((await bench.frames())[-1], frame, f"{name}, bit {bit}")
        want = camera_window(taken, crop, built.words_per_pixel, pairs)
        assert bench.faults == [fault for _, fault in want.faults], f"{name}, bit {bit}"
        bench.forget()


@on_bench(Bench, milliseconds=20)
async def resets(bench: Bench) -> None:
    """Reset anywhere in a picture and after it; the next picture is right."""
    for clocks in (1, 7, 60, 200, *(bench.random.randrange(500) for _ in range(4))):
        cocotb.start_soon(bench.source.send(bench.picture()[0]))
        await ClockCycles(bench.dut.clk, clocks)
        await bench.reset(1)
        words, frame = bench.picture()
        await bench.source.send(words)
        np.testing.assert_array_equal(await bench.frames(), [frame], f"reset after {clocks} clocks")
        bench.forget()
