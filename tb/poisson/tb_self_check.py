# SPDX-License-Identifier: Apache-2.0
"""self_check against its model: the verdict in every clock; frames without a pause, gaps, pauses, the bound, reset."""

import random
from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import RisingEdge

from formal.entries import Proof
from tactile_depth.chip.poisson.divergence_sums import sums
from tactile_depth.chip.poisson.self_check import Check, latency, self_check
from tb.pins import Driver
from tb.stream import parameters, parametrize, start_clock, uniform
from tb.structures import ICARUS, VERILATOR, of_parameters

NAMES = (
    "Rows Columns Lanes InWidth Width InDropped Dropped Scale ScaleFraction SumWidth Bound Neumann BottomFirst "
    "FrameLatency Parity"
)
built = of_parameters(NAMES)
STRUCTURES = (
    built(9, 64, 1, 15, 15, 5, 4, 16130, 14, 11, 212, 1, 1, 300, 1, on=VERILATOR),
    built(8, 32, 1, 8, 7, 1, 0, 101, 7, 10, 30, 0, 0, 270, 0, on=ICARUS, mutants=ICARUS),
    built(9, 32, 4, 9, 8, 0, 2, 77, 7, 9, 40, 1, 1, 45, 1, on=ICARUS, mutants=ICARUS),
    built(8, 32, 2, 7, 7, 0, 1, 77, 7, 8, 20, 0, 1, 75, 0, on=ICARUS, mutants=ICARUS),
    built(8, 64, 8, 12, 14, 3, 3, 3000, 12, 12, 1504, 0, 1, 100, 0),
    built(8, 64, 1, 24, 24, 5, 3, 14564, 14, 23, 3405, 1, 0, 600, 0),
    built(96, 128, 1, 15, 15, 5, 4, 32255, 15, 11, 212, 1, 1, 565, 1),
)
PROOFS = (
    Proof("rows and beats are only counted; any largest residual", {"Rows": 2, "Lanes": 1}, free=("largest",)),
    Proof("trees; a number of rows that does not", {"Rows": 3, "Lanes": 4}, free=("largest",)),
)
PINS = ["rst", "in_valid", "in_frame_start", "in_data", "out_start", "out_frame_start", "out_data"]
FRAMES = 5


def check_of(dut: Any) -> Check:
    """Return the check of the device."""
    names = "Neumann Dropped InDropped Scale ScaleFraction SumWidth Bound"
    neumann, *numbers = parameters(dut, *names.split())
    return Check(bool(neumann), *numbers)


class Timeline:
    """Pins in each cycle with en, and the cycles of the verdicts: frames in, and out as a solver lets them leave."""

    def __init__(self, dut: Any, gap: float, rest: float) -> None:
        names = "Rows Columns Lanes Width BottomFirst FrameLatency"
        self.rows, self.columns, self.lanes, self.width, self.bottom_first, self.frame_latency = parameters(
            dut, *names.split()
        )
        self.chance, self.gap, self.rest = np.random.default_rng(cocotb.RANDOM_SEED), gap, rest
        self.pins: dict[int, dict[str, int]] = {}
        self.now = self.left = 0  # the next cycle for a word, and for depths
        self.ends: list[int] = []  # cycles of the last depths of the frames

    def add(self, f: Any, z: Any) -> None:
        """Let a frame come, and its depths leave."""
        pixels = self.rows * self.columns
        self.now = max(self.now, self.left - self.frame_latency - pixels)  # a solver holds no frame back
        for n, word in enumerate(f.ravel().tolist()):
            while self.chance.random() < self.gap:
                self.now += 1
            self.set(self.now, in_valid=1, in_frame_start=int(n == 0), in_data=word)
            self.now += 1
        self.left = max(self.left, self.now - 1 + self.frame_latency)
        for n, row in enumerate(z[::-1] if self.bottom_first else z):
            while n and self.chance.random() < self.rest:
                self.left += 1
            for beat, codes in enumerate(row.reshape(-1, self.lanes).tolist()):
                data = sum((code & (1 << self.width) - 1) << lane * self.width for lane, code in enumerate(codes))
                self.set(self.left, out_start=int(beat == 0), out_frame_start=int(beat == n == 0), out_data=data)
                self.left += 1
        self.ends.append(self.left - 1)

    def at(self, cycle: int) -> dict[str, int]:
        return self.pins.setdefault(cycle, dict.fromkeys(PINS, 0))

    def set(self, cycle: int, **values: int) -> None:
        self.at(cycle).update(values)

    def stimuli(self) -> list[dict[str, int]]:
        last = max(self.pins) + latency(self.lanes) + 12
        return [self.at(cycle) for cycle in range(last)]


async def play(dut: Any, stimuli: list[dict[str, int]], ends: dict[int, Any], pause: float) -> None:
    """Play cycles with en, and check the verdict in every clock.

    Parameters
    ----------
    ends : dict
        The cycle of the last depths of each frame to its residual.
    pause : float
        Chance of a clock without en before each cycle, with its pins. The check goes on in it.
    """
    (lanes,), bound = parameters(dut, "Lanes"), check_of(dut).bound
    chance, edge, write = random.Random(cocotb.RANDOM_SEED), RisingEdge(dut.clk), Driver(dut)
    start_clock(dut.clk)
    write(**dict.fromkeys(PINS, 0) | {"rst": 1, "en": 1})
    await edge
    await edge
    residual, begun = 0, False
    waiting: list[tuple[int, int]] = []  # clocks to each verdict that is to come
    for cycle, words in enumerate(stimuli):
        en = False
        while not en:
            en = chance.random() >= pause
            write(**words, en=en)
            await edge
            got = int(dut.residual.value), int(dut.beyond.value)
            assert got == (residual, residual > bound), f"cycle {cycle}"
            assert not (begun and int(dut.flipped.value)), f"cycle {cycle}"
            waiting = [(left - 1, size) for left, size in waiting]
            if en and cycle in ends:
                waiting.append((latency(lanes) - 1, ends[cycle]))
            if waiting and not waiting[0][0]:
                residual, begun = waiting.pop(0)[1], True
            if words["rst"]:  # with en or not
                waiting, residual = [], 0
    assert not waiting


async def check(dut: Any, f: Any, z: Any, gap: float = 0.0, rest: float = 0.0, pause: float = 0.0) -> None:
    timeline = Timeline(dut, gap, rest)
    for frame in zip(f, z, strict=True):
        timeline.add(*frame)
    ends = dict(zip(timeline.ends, self_check(f, z, check_of(dut)).tolist(), strict=True))
    await play(dut, timeline.stimuli(), ends, pause)


def random_frames(dut: Any, frames: int, amplitude: float | None) -> Any:
    rows, columns, in_width, width = parameters(dut, "Rows", "Columns", "InWidth", "Width")
    shape = (frames, rows, columns)
    return uniform(shape, in_width, amplitude), uniform(shape, width, amplitude)[:, ::-1, ::-1]


@cocotb.test
@parametrize(
    (("gap", "rest", "pause"), [(0.0, 0.0, 0.0), (0.0, 0.0, 0.3), (0.2, 0.0, 0.0), (0.1, 0.3, 0.2)]),
    ("amplitude", [1.0, None, 0.1]),
)
async def frames(dut: Any, gap: float, rest: float, pause: float, amplitude: float | None) -> None:
    f, z = random_frames(dut, FRAMES, amplitude)
    await check(dut, f, z, gap, rest, pause)


@cocotb.test
async def single_rows(dut: Any) -> None:
    """Send frames that are zero but for one row, near the signs of a pattern, so that its sums alone decide."""
    chance = np.random.default_rng(cocotb.RANDOM_SEED)
    rows, columns, in_width, width = parameters(dut, "Rows", "Columns", "InWidth", "Width")
    all_but_last, *minus = sums(columns)
    patterns = np.stack([all_but_last, *(all_but_last - 2 * signs for signs in minus)])
    counts = 32 * FRAMES if rows * columns < 1024 else FRAMES
    f, z = np.zeros((2, counts, rows, columns), np.int64)
    for frame in range(counts):
        words, bits = ((f, in_width), (z, width))[chance.integers(2)]
        size, noise = chance.integers(1 << chance.integers(bits - 1)), chance.integers(-1, 2, columns)
        pattern = chance.choice([-1, 1]) * patterns[chance.integers(len(patterns))]
        words[frame, chance.integers(rows)] = size * pattern + noise
    await check(dut, f, z)


@cocotb.test
async def near_the_bound(dut: Any) -> None:
    """Send frames whose residuals are the bound, one more and one less, from either side of zero."""
    rows, columns, in_width = parameters(dut, "Rows", "Columns", "InWidth")
    device, largest = check_of(dut), min(1 << in_width - 1, 1 << 13)
    words = np.arange(-largest, largest)
    f = np.zeros((len(words), 2, columns), np.int64)
    for column in range(columns - 1):  # no more than it takes, so that no residual is left out
        f[:, 1, column] = words
        residuals = self_check(f, np.zeros_like(f), device)
        if residuals[0] > device.bound < residuals[-1]:
            break
    near = [
        np.flatnonzero((residuals == device.bound + more) & (words * side > 0))[:1]
        for more in (0, 1, -1)
        for side in (1, -1)
    ]
    chosen = np.zeros((sum(map(len, near)), rows, columns), np.int64)
    chosen[:, -1] = f[np.concatenate(near), 1]
    await check(dut, chosen, np.zeros_like(chosen))


@cocotb.test
@parametrize(cycles=[1, 40, 200, 333])
async def reset(dut: Any, cycles: int) -> None:
    """Reset some cycles before the end of what is played; then other frames come."""
    f, z = random_frames(dut, 4, 1.0)
    residuals = self_check(f, z, check_of(dut)).tolist()
    parts = [Timeline(dut, 0.0, 0.0) for _ in range(2)]
    for n, frame in enumerate(zip(f, z, strict=True)):
        parts[n // 2].add(*frame)
    before = parts[0].stimuli()
    before = before[: max(1, parts[0].ends[-1] + latency(parts[0].lanes) - cycles)]
    begun = len(before) + 1
    ends = {end: residual for end, residual in zip(parts[0].ends, residuals[:2], strict=True) if end < begun}
    ends |= {begun + end: residual for end, residual in zip(parts[1].ends, residuals[2:], strict=True)}
    clear = dict.fromkeys(PINS, 0) | {"rst": 1}
    await play(dut, [*before, clear, *parts[1].stimuli()], ends, 0.1 * (cycles % 2))
