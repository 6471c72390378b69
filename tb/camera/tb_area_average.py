# SPDX-License-Identifier: Apache-2.0
"""area_average against its model: every kind of frame, gaps, pauses, broken frames, resets; words, marks, latency."""

from typing import Any

import cocotb
import numpy as np

from formal.entries import Proof
from tactile_depth.chip.camera.area_average import LATENCY, UNITY, area_average
from tactile_depth.chip.camera_configuration import GAIN
from tb.camera.slots import Slot, Slots, Window, packed
from tb.cases import on_bench
from tb.stream import MANY, check_words, drive, parameters, parametrize
from tb.structures import ICARUS, VERILATOR, Mutants, Structure

GRID = {"Rows": 3, "Columns": 8}
RATIOS = [(8, 1), (1, 1), (5, 4), (9, 5), (2, 1), (7, 3), (5, 2), (15, 4), (16, 5), (29, 4), (47, 8)]
PATTERN_RATIOS = [ratio for ratio in RATIOS if ratio[0] >= 2 * ratio[1]]


def built(numerator: int, denominator: int, bits: int, bayer: int, **runs: Any) -> Structure:
    ratio = {"Numerator": numerator, "Denominator": denominator}
    return Structure({**GRID, **ratio, "Bits": bits, "Bayer": bayer}, **runs)


STRUCTURES = (
    built(15, 4, 10, 1, on=VERILATOR),
    built(5, 4, 8, 0, on=VERILATOR),
    built(5, 2, 12, 1, on=ICARUS, mutants=ICARUS),
    built(1, 1, 8, 0, on=ICARUS),
    built(3, 2, 10, 0, on=ICARUS, mutants=ICARUS),
    *(built(*ratio, 8, 0) for ratio in RATIOS if ratio not in ((1, 1), (5, 4))),
    *(built(*ratio, 10, 1) for ratio in PATTERN_RATIOS if ratio != (15, 4)),
    built(2, 1, 8, 1),
    built(2, 1, 12, 1),
    built(8, 1, 10, 0),
)
MUTANTS = Mutants(repeats=2, flat=False)
PROOFS = tuple(
    Proof(
        "rows and columns are only counted; what is complete is proven of row_sums and block_totals",
        {"Rows": rows, "Columns": columns},
        free=("complete",),
    )
    for rows, columns in ((3, 4), (2, 5))
)


GAINS_TAKEN = 5  # slots from the first pixel of a frame to the one in which its gains are taken
OUTPUTS = ["out_valid", "out_pixel", "out_last", "out_user"]


class Bench:
    """Pixels to send, and the words expected: slot, red, green, blue, last, user; -1 as the colours of an abort."""

    def __init__(self, dut: Any) -> None:
        self.dut = dut
        names = ("Rows", "Columns", "Numerator", "Denominator", "Bits", "Bayer")
        self.rows, self.columns, self.numerator, self.denominator, self.bits, self.bayer = parameters(dut, *names)
        self.width, self.channels = self.bits + 2, 1 if self.bayer else 3
        self.window = Window(self.rows, self.columns, self.numerator, self.denominator)
        self.shape = (self.window.height, self.window.width, *([] if self.bayer else [3]))
        pins = {"in_samples": self.channels * self.width, "in_colour": 2, "in_row_start": 1, "in_frame_start": 1}
        self.slots = Slots(pins)
        self.gains = UNITY
        self.taken: dict[int, int] = {}  # slot to the gains that a frame takes there
        self.rng = np.random.default_rng(cocotb.RANDOM_SEED)
        self.stimuli: list[Slot] = []
        self.expected: list[Any] = []
        self.place = 0  # words of the frame that are expected so far

    def samples(self, kind: str) -> np.ndarray:
        """Return samples of a frame: within full scale, over the whole range, constant near a tie, or at the limits."""
        white, limit = (1 << self.bits) - 1, 1 << (self.width - 1)
        if kind == "picture":
            return self.rng.integers(0, white, self.shape, endpoint=True)
        if kind == "range":
            return self.rng.integers(-limit, limit - 1, self.shape, endpoint=True)
        if kind == "ties":  # half a grey level, and one pixel in eight beside it
            half = (1 << self.bits >> 8) // 2
            tie = 2 * half * int(self.rng.integers(0, 256)) + half
            return tie + self.rng.choice([0] * 30 + [-1, 1], self.shape)
        return np.full(self.shape, {"black": 0, "white": white, "lowest": -limit, "highest": limit - 1}[kind])

    def frame(self, samples: np.ndarray, gap: float = 0.0, pixels: int | None = None) -> None:
        """Append a frame, of which only the first `pixels` pixels are sent."""
        blue_row, blue_column = (self.slots.random.getrandbits(1) for _ in range(2))
        colour = (blue_row, blue_column) if self.bayer else None
        means = area_average(samples, self.bits, self.numerator, self.denominator, colour, self.gains).reshape(-1, 3)
        completes = self.window.completes().reshape(-1)
        words = []
        for place, marks in enumerate(self.window.marks()):
            row, column = divmod(place, self.window.width)
            pixel = packed(np.atleast_1d(samples[row, column]), self.width)
            site = (row + blue_row & 1) << 1 | column + blue_column & 1
            words.append({"in_samples": pixel, "in_colour": site, **marks})
        place = -1
        for slot in self.slots.apart(words[:pixels], gap):
            place += slot["in_valid"]
            if slot["in_valid"] and completes[place]:
                self.leaves(means[self.place].tolist())
            if slot["in_valid"] and place == 0:
                self.taken[len(self.stimuli) + GAINS_TAKEN] = packed(self.gains, GAIN.width)
            self.append(slot)

    def append(self, slot: Slot) -> None:
        """Append a slot. Gains move with every slot, and hold still for no frame."""
        self.stimuli.append(slot | {"in_gains": self.slots.random.getrandbits(3 * GAIN.width)})

    def leaves(self, colours: list[int], abort: int = 0) -> None:
        last = int((self.place + 1) % self.columns == 0) ^ abort
        self.expected.append([len(self.stimuli), *colours, last, int(self.place == 0)])
        self.place = 0 if abort else (self.place + 1) % (self.rows * self.columns)

    def abort(self) -> None:
        self.leaves([-1, -1, -1], abort=1)
        self.append(self.slots.idle(in_abort=1))

    def reset(self) -> None:
        """A reset drops every block inside."""
        reset = len(self.stimuli)
        self.expected = [word for word in self.expected if word[0] + LATENCY <= reset]
        self.append(self.slots.idle(rst=1))
        self.place = 0

    async def check(self, pause: float = 0.0) -> None:
        for _ in range(LATENCY + 1):
            self.append(self.slots.idle())
        for slot, gains_of_frame in self.taken.items():
            self.stimuli[slot]["in_gains"] = gains_of_frame
        outputs = await drive(self.dut, self.stimuli, OUTPUTS, pause)
        aborts = {word[0] for word in self.expected if word[1] < 0}
        got = []
        for clock in range(len(self.stimuli)):
            if int(outputs["out_valid"][clock]):
                slot, pixel = clock - LATENCY, outputs["out_pixel"][clock]
                colours = [-1] * 3 if slot in aborts else [int(pixel) >> shift & 255 for shift in (16, 0, 8)]
                got.append([slot, *colours, int(outputs["out_last"][clock]), int(outputs["out_user"][clock])])
        check_words(np.array(got), np.array(self.expected), self.columns, self.rows)


@on_bench(Bench, milliseconds=20)
@parametrize((("gap", "pause"), [(0.0, 0.0), (0.4, 0.0), (0.2, 0.2)]))
async def frames(bench: Bench, gap: float, pause: float) -> None:
    for kind in ("black", "white", "lowest", "highest", *["range", "picture", "ties"] * MANY):
        bench.frame(bench.samples(kind), gap)
    await bench.check(pause)


@on_bench(Bench, milliseconds=20)
@parametrize((("gap", "pause"), [(0.0, 0.0), (0.3, 0.2)]))
async def gains(bench: Bench, gap: float, pause: float) -> None:
    """Change the gains with every frame: 0, 1, the largest, each bit, and random ones."""
    chance, largest = bench.slots.random, (1 << GAIN.width) - 1
    for bit in range(GAIN.width):
        of = [1 << bit, chance.choice((0, largest)), chance.getrandbits(GAIN.width)]
        for kind in chance.sample(["range", "picture", "ties", "white"], 2):
            chance.shuffle(of)
            bench.gains = (of[0], of[1], of[2])
            bench.frame(bench.samples(kind), gap)
    await bench.check(pause)


@on_bench(Bench, milliseconds=20)
async def a_gain_of_8_clips_the_mean_alone(bench: Bench) -> None:
    """A quarter of each block is white: times 8 the mean is white, although a pixel alone would exceed the scale."""
    bench.gains = (8 * UNITY[0],) * 3
    height, width = bench.shape[:2]
    white = np.zeros(bench.shape, np.int64)
    white[: height // 2, : width // 2] = (1 << bench.bits) - 1
    bench.frame(white)
    bench.frame(white // 16)
    await bench.check()


@on_bench(Bench, milliseconds=20)
@parametrize(gap=[0.0, 0.3])
async def broken_frames(bench: Bench, gap: float) -> None:
    """Break a frame after each of its first pixels, at random positions, and between frames; the next one follows at
    once or later."""
    pixels = bench.window.height * bench.window.width
    anywhere = [bench.slots.random.randrange(pixels) for _ in range(10)]
    row_end = [pixels - 1, pixels - 2, pixels - bench.window.width, pixels - bench.window.width - 1]
    bench.abort()
    for count in (0, 1, 2, 3, bench.window.width, *row_end, *anywhere):
        if count:
            bench.frame(bench.samples("picture"), gap, count)
        bench.abort()
        if bench.slots.random.random() < 0.3:
            bench.abort()
        if bench.slots.random.random() < 0.3:
            bench.frame(bench.samples("picture"), gap)
    bench.frame(bench.samples("picture"), gap)
    await bench.check()


@on_bench(Bench, milliseconds=20)
async def resets(bench: Bench) -> None:
    """Reset at random positions: no block inside leaves, and the next frame is right, also if it breaks at once."""
    pixels = bench.window.height * bench.window.width
    for age in range(LATENCY + 2):
        if age % 2:
            bench.frame(bench.samples("picture"), pixels=pixels - bench.slots.random.randrange(2 * bench.columns))
        else:
            bench.frame(bench.samples("picture"))
            bench.abort()
        for _ in range(age):
            bench.append(bench.slots.idle())
        bench.reset()
        if age % 3:
            bench.abort()
    bench.frame(bench.samples("picture"))
    await bench.check()
