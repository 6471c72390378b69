# SPDX-License-Identifier: Apache-2.0
"""pixel_format against its model: every code of every field, any window, gaps, pauses, broken pictures, resets."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import FULL_WIDTH, Proof
from tactile_depth.chip.camera.pixel_format import colours, pixel_format, pixel_format_parameters, raw_shift
from tactile_depth.chip.camera.pixel_format import latency as pixel_format_latency
from tactile_depth.chip.camera_configuration import FORMATS, PHASES, CameraConfiguration
from tb.camera.slots import Slot, Slots, unpacked
from tb.cases import on_bench
from tb.settings import RUN
from tb.stream import MANY, drive, parametrize
from tb.structures import BOTH, ICARUS, VERILATOR, Mutants, Structure

PICTURE, GRID = (96, 64), (2, 2)
RAW = [name for name, form in FORMATS.items() if form.bayer]


def built(form: str, phase: int, **runs: Any) -> Structure:
    arguments: dict[str, Any] = {"picture": PICTURE, "grid": GRID, "pixel_format": form, "phase": PHASES[phase]}
    camera = CameraConfiguration(**arguments)
    return Structure(pixel_format_parameters(camera), device={"camera": arguments}, **runs)


STRUCTURES = (
    built("yuyv", 0, on=BOTH, mutants=ICARUS),
    built(
        "raw10",
        1,
        on=VERILATOR,
    ),
    built("raw10_lsb", 2, on=ICARUS, mutants=ICARUS),
    built("rgb565_bytes", 0, on=ICARUS, mutants=ICARUS),
    built(
        "rgb888",
        0,
        on=ICARUS,
    ),
    built(
        "rgb565",
        0,
    ),
    built("yuyv_bytes", 0),
    built(
        "raw8",
        3,
    ),
    built(
        "raw12_lsb",
        2,
    ),
    *(built(form, phase) for form in RAW for phase in range(4)),
)
MUTANTS = Mutants(repeats=2)
PROOFS = (
    *(
        Proof(
            FULL_WIDTH,
            {"Format": FORMATS[form].code, "Phase": phase},
        )
        for form, phase in (
            *(("rgb888", 0), ("rgb565", 0), ("rgb565_bytes", 0), ("raw8", 1), ("raw10", 0), ("raw10_lsb", 2)),
            *(("raw12", 3), ("raw12_lsb", 0)),
        )
    ),
    Proof(
        FULL_WIDTH,
        {"Format": FORMATS["yuyv"].code},
    ),
)


def camera(form: str, **choices: Any) -> CameraConfiguration:
    return CameraConfiguration((2, 4), (1, 1), form, **choices)


OUTPUTS = ["out_valid", "out_samples", "out_colour", "out_row_start", "out_frame_start", "out_abort"]
Place = tuple[int, int, int, int]  # x, y, width, height
MARKS = ("in_inside", "in_odd_row", "in_odd_column", "in_row_start", "in_frame_start")


class Bench:
    def __init__(self, dut: Any) -> None:
        self.dut = dut
        self.camera = CameraConfiguration(**RUN.device["camera"])
        self.bayer, self.yuyv = self.camera.format.bayer, self.camera.format.is_yuyv
        self.latency = pixel_format_latency(self.camera)
        self.slots = Slots({"in_data": 24, **dict.fromkeys(MARKS, 1)})
        self.rng = np.random.default_rng(cocotb.RANDOM_SEED)
        self.stimuli: list[Slot] = []
        self.expected: list[Any] = []  # slot in which each leaves; abort, or samples, colour and marks

    def every_code(self) -> np.ndarray:
        """Return words of a picture in which every bit field takes each of its values, beside random values of the
        others."""
        rows, columns = self.camera.picture
        words = self.rng.integers(0, 1 << 24, rows * columns)
        form = self.camera.pixel_format.removesuffix("_bytes")
        fields = {"rgb888": (0, 8, 16), "rgb565": (0, 5, 8), "yuyv": (0, 8)}.get(form, (raw_shift(self.camera),))
        width = self.camera.bits if self.bayer else 8
        place = 0
        for low in fields:
            for code in range(1 << width):
                for _ in range(2 if self.yuyv else 1):  # of both columns of a pair
                    words[place] = words[place] & ~(((1 << width) - 1) << low) | code << low
                    place += 1
        return words.reshape(rows, columns)

    def picture(self, words: np.ndarray, window: Place, gap: float, pixels: int | None = None) -> None:
        """Append a picture, of which only the first `pixels` pixels are sent."""
        samples = pixel_format(words, self.camera)
        x, y, width, height = window
        place = 0
        for slot in self.slots.apart([{}] * (words.size if pixels is None else pixels), gap):
            if slot["in_valid"]:
                row, column = divmod(place, words.shape[1])
                starts = column == x and y <= row < y + height
                slot |= {
                    "in_data": int(words[row, column]),
                    "in_inside": int(x <= column < x + width and y <= row < y + height),
                    "in_odd_row": row % 2,
                    "in_odd_column": column % 2,
                    "in_row_start": int(starts),
                    "in_frame_start": int(starts and row == y),
                }
                site = (row % 2 << 1 | column % 2) ^ self.camera.phase_code if self.bayer else None
                if self.yuyv and column % 2:  # a pair leaves
                    for second in (0, 1):
                        at = column - 1 + second
                        if y <= row < y + height and x <= at < x + width:
                            first = [int(at == x), int(at == x and row == y)]
                            out = len(self.stimuli) + self.latency - 1 + second
                            self.expected.append((out, samples[row, at].tolist(), None, *first))
                elif not self.yuyv and slot["in_inside"]:
                    out = len(self.stimuli) + self.latency
                    marks = slot["in_row_start"], slot["in_frame_start"]
                    self.expected.append((out, np.atleast_1d(samples[row, column]).tolist(), site, *marks))
                place += 1
            self.stimuli.append(slot)

    def abort(self) -> None:
        self.expected.append((len(self.stimuli) + self.latency, "abort"))
        self.stimuli.append(self.slots.idle(in_abort=1))

    def reset(self) -> None:
        self.expected = [word for word in self.expected if word[0] <= len(self.stimuli)]
        self.stimuli.append(self.slots.idle(rst=1))

    def window(self) -> Place:
        """Return a window: at the edges, of one pixel, or random."""
        rows, columns = self.camera.picture
        chance = self.slots.random
        x, y = chance.choice((0, columns - 1, chance.randrange(columns))), chance.choice((0, chance.randrange(rows)))
        return x, y, chance.choice((1, columns - x, chance.randint(1, columns - x))), chance.randint(1, rows - y)

    async def check(self, pause: float = 0.0) -> None:
        self.stimuli += [self.slots.idle() for _ in range(self.latency + 2)]
        pins = await drive(self.dut, self.stimuli, OUTPUTS, pause)
        got: list[Any] = []
        channels = 1 if self.bayer else 3
        for clock in range(len(self.stimuli)):
            if int(pins["out_abort"][clock]):
                got.append((clock, "abort"))
            if int(pins["out_valid"][clock]):
                samples = unpacked(pins["out_samples"][clock], self.camera.sample_width, channels)
                colour = int(pins["out_colour"][clock]) if self.bayer else None
                marks = int(pins["out_row_start"][clock]), int(pins["out_frame_start"][clock])
                got.append((clock, samples, colour, *marks))
        for number, (word, want) in enumerate(zip(got, self.expected, strict=False)):
            assert word == want, f"word {number}"
        assert len(got) == len(self.expected)


@on_bench(Bench, milliseconds=20)
async def every_code(bench: Bench) -> None:
    rows, columns = bench.camera.picture
    bench.picture(bench.every_code(), (0, 0, columns, rows), 0.0)
    if bench.bayer:
        assert {0, 1, 2} == set(colours(bench.camera).flat)
    await bench.check()


@on_bench(Bench, milliseconds=20)
@parametrize((("gap", "pause"), [(0.0, 0.0), (0.5, 0.0), (0.2, 0.3)]))
async def windows(bench: Bench, gap: float, pause: float) -> None:
    """Send whole and broken pictures with random windows; the picture after a broken one follows at once or later."""
    small = bench.rng.integers(0, 1 << 24, (4, 6))
    bench.camera = CameraConfiguration(**{**RUN.device["camera"], "picture": small.shape, "grid": (2, 2)})
    for _ in range(10 * MANY):
        bench.picture(small, bench.window(), gap)
        if bench.slots.random.random() < 0.5:
            bench.abort()
        if bench.slots.random.random() < 0.5:
            bench.picture(small, bench.window(), gap, bench.slots.random.randrange(1, small.size))
            bench.abort()
    await bench.check(pause)


@on_bench(Bench, milliseconds=20)
async def resets(bench: Bench) -> None:
    small = bench.rng.integers(0, 1 << 24, (4, 6))
    bench.camera = CameraConfiguration(**{**RUN.device["camera"], "picture": small.shape, "grid": (2, 2)})
    for age in range(bench.latency + 2):
        for pixels in (6, 5, 4):
            bench.picture(small, (0, 0, 6, 4), 0.0, pixels)
            if pixels == 4:
                bench.abort()
            bench.stimuli += [bench.slots.idle() for _ in range(age)]
            bench.reset()
    bench.picture(small, (0, 0, 6, 4), 0.0)
    await bench.check()
