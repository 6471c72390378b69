# SPDX-License-Identifier: Apache-2.0
"""light_gains against its model: light that changes, contacts, counts and gains at their limits, gains written.

The reference follows the pins in every cycle: a frame uses the gains that stood when its first pixel came.
"""

from typing import Any

import cocotb
import numpy as np
from cocotb.triggers import RisingEdge

from formal.entries import ROUNDING, Proof
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.fixed_point import Format
from tactile_depth.chip.gradient.light_gains import LATENCY, RATES, Light
from tb.cases import on_bench
from tb.pins import by_name
from tb.stream import (
    MANY,
    Bench,
    StreamDriver,
    StreamMonitor,
    check_words,
    parameters,
    parametrize,
    raster,
    sample,
    send_apart,
)
from tb.structures import ICARUS, VERILATOR, Mutants, Structure


def built(rows: int, columns: int, *widths: Any, **runs: Any) -> Structure:
    return Structure(Light(rows, columns, *widths).parameters, **runs)


SMALL = 8, 6, 8, Format(7, 5)
STRUCTURES = (
    built(8, 16, on=VERILATOR),
    built(3, 8, *SMALL, on=ICARUS, mutants=ICARUS),
    built(9, 32),
    built(2, 11, *SMALL),
)
PROTOCOL = {
    "raster_places": {},
    "in_position": "place",
    "counts": "live & ~reset & en",
    "gains": "live",
    "saturations": "live & ~reset",
    "out_position out_red out_green out_blue": "counts & out_valid",
}
MUTANTS = Mutants(repeats=6)
PROOFS = (
    Proof(
        f"products are exact at any width; rows and columns are only counted; {ROUNDING}",
        {"Moves": 0, "RatioWidth": 3, "GainWidth": 4, "OutWidth": 5, "OutFraction": 3},
    ),
    Proof(
        "sums are exact at any width; the shortest row leaves the least time; deviations of any value",
        {"Moves": 1},
        steps=20,
        free=("deviations",),
    ),
)


RATIOS = ["red", "green", "blue", "position"]
WIDTHS = ["Rows", "Columns", "RatioWidth", "RatioFraction", "GainWidth", "OutWidth", "OutFraction"]
PIXELS = 2048  # that a test sends, at most, unless a frame has more


class Gains:
    """Device, its gains as the model has them, and frames of every kind."""

    def __init__(self, dut: Any, gap: float = 0.0, pause: float = 0.0) -> None:
        self.dut, self.gap = dut, gap
        rows, columns, ratio, ratio_fraction, gain, width, fraction = parameters(dut, *WIDTHS)
        self.light = Light(rows, columns, ratio, ratio_fraction, gain, Format(width, fraction))
        self.shape = (self.light.rows, self.light.columns, 3)
        self.places = raster(*self.shape[:2])
        self.frames = max(4, PIXELS // len(self.places))
        self.bench = Bench(dut, pause)
        self.chance = np.random.default_rng(cocotb.RANDOM_SEED)
        self.driver = StreamDriver(dut, "in", "valid", RATIOS)
        self.source = StreamMonitor(dut, "in", "valid", RATIOS, unsigned=RATIOS)
        self.sink = StreamMonitor(dut, "out", "valid", RATIOS, unsigned=["position"])
        self.monitor = Monitor()
        self.used: list[np.ndarray] = []
        for pin in ("rate", "write", "write_gain", "in_bad"):
            getattr(dut, pin).value = 0
        dut.follow.value = 1

    async def start(self) -> None:
        await self.bench.start()
        cocotb.start_soon(self.run())

    async def run(self) -> None:
        """Follow the pins: the gains of each frame, and those that stand after each cycle."""
        light, read, edge = self.light, by_name(self.dut), RisingEdge(self.dut.clk)
        gains, word = np.full(3, light.unity), self.word([light.unity] * 3)
        bad, ratios = False, list[list[int]]()
        while True:
            await edge
            assert read("gains") == word, f"gains {read('gains'):#x}, expected {word:#x}: {gains.tolist()}"
            before = gains
            if read("en"):
                bad |= bool(read("in_bad"))
                if read("in_valid"):
                    place = read("in_position")
                    if place & 3 == 3:
                        self.used.append(gains)
                        ratios = []
                    ratios.append([read(f"in_{colour}") for colour in RATIOS[:3]])
                    if place & 12 == 12:
                        if read("follow") and not bad:
                            deviations = light.deviations(np.array(ratios).reshape(self.shape), self.used[-1])
                            gains = light.followed(deviations, gains, self.used[-1], read("rate"))
                        bad = False
            if write := read("write"):
                written = light.limited(np.array(read("write_gain")))
                gains = np.where([write >> c & 1 for c in range(3)], written, gains)
            if read("rst"):
                gains, bad = np.full(3, light.unity), False
            if gains is not before:
                word = self.word(gains.tolist())

    def word(self, gains: list[int]) -> int:
        """Return the gains of the colours as the pin shows them."""
        return sum(gain << self.light.gain_width * c for c, gain in enumerate(gains))

    # Pictures, int64 (rows, columns, 3).

    def picture(self, level: Any, contact: float = 0.0) -> np.ndarray:
        """Return ratios near `level` in each colour, a part of the pixels in contact, a few black."""
        light = self.light
        noise = self.chance.normal(0, 0.03, self.shape)
        touched = self.chance.random(self.shape[:2]) < contact
        noise += np.where(touched[..., None], self.chance.uniform(-0.8, 0.8, self.shape), 0)
        ratios = np.rint(np.array(level) * (1 + noise) * (1 << light.ratio_fraction)).astype(np.int64)
        ratios[self.chance.random(self.shape[:2]) < 0.05] = 0
        return ratios.clip(0, (1 << light.ratio_width) - 1)

    def of_deviations(self, deviations: np.ndarray) -> np.ndarray:
        """Return the ratios that have these deviation codes while the gains are 1."""
        light = self.light
        return (deviations + (1 << light.deviation.fraction)) << (light.ratio_fraction - light.deviation.fraction)

    async def send(self, ratios: np.ndarray, bad: int | None = None, pixels: int | None = None) -> None:
        """Send a frame, or its first `pixels`; `bad` is the pixel with which it turns out to be malformed."""
        words = np.column_stack((ratios.reshape(-1, 3), self.places))[:pixels].tolist()
        parts = [words] if bad is None else [words[:bad], words[bad : bad + 1], words[bad + 1 :]]
        for index, part in enumerate(parts):
            while index == 1 and self.bench.random.random() < self.gap:
                await self.bench.clocks(1)
            self.dut.in_bad.value = int(index == 1)
            await send_apart(self.bench, self.driver, part, 0.0 if index == 1 else self.gap)
        self.dut.in_bad.value = 0

    async def write(self, gain: int, colours: int) -> None:
        self.dut.write.value, self.dut.write_gain.value = colours, gain
        await RisingEdge(self.dut.clk)
        self.dut.write.value = 0

    async def check(self) -> None:
        await self.bench.clocks(LATENCY + 2)
        words = np.array(self.source.words)
        ratios = words[:, :3].reshape(-1, *self.shape)
        gains = np.array(self.used)[:, None, None]
        want = self.light.deviations(ratios, gains, self.monitor).reshape(-1, 3)
        check_words(
            np.array(self.sink.words), np.column_stack((want, words[:, 3])), self.light.columns, self.light.rows
        )
        assert self.sink.starts == [clock + LATENCY for clock in self.source.starts]
        clipped = self.monitor.saturations.total()
        assert self.bench.saturations == clipped, f"{self.bench.saturations} values clipped, {clipped} in the model"

    def forget(self) -> None:
        self.source.forget()
        self.sink.forget()
        self.used, self.monitor = [], Monitor()


TRAFFIC = parametrize((("gap", "pause"), sample([(0.0, 0.0), (0.0, 0.3), (0.3, 0.0), (0.5, 0.5)])))


@on_bench(Gains, milliseconds=60)
@TRAFFIC
async def light_and_contacts(device: Gains) -> None:
    """Change light, contact, filter and faults from frame to frame: gains step, follow, and are held."""
    chance, level = device.chance, np.ones(3)
    for _ in range(device.frames * MANY):
        if chance.random() < 0.2:
            level = chance.uniform(0.4, 2.2, 3)
        device.dut.follow.value = int(chance.random() < 0.9)
        device.dut.rate.value = int(chance.integers(RATES)) if chance.random() < 0.5 else 0
        bad = int(chance.choice([0, *chance.integers(0, len(device.places), 2), len(device.places) - 1]))
        contact = chance.choice([0.0, 0.2, 0.6, 0.9])
        await device.send(device.picture(level, contact), bad if chance.random() < 0.2 else None)
    await device.check()
    assert len(np.unique(device.used, axis=0)) > 1, "the test is void: no gain moved"


@on_bench(Gains, milliseconds=60)
async def counts_at_their_limits(device: Gains) -> None:
    """Put so many pixels just at and just within 1/8 that one more or less decides; and means beside ties."""
    light, chance = device.light, device.chance
    pixels, near = light.pixels, light.near
    half, quarter = -(-pixels // 2), -(-pixels // 4)
    for sign in (1, -1):
        for count in (half - 1, half, half + 1, pixels - quarter, pixels - quarter + 1):
            colour = int(chance.integers(3))
            deviations = np.zeros((pixels, 3), np.int64)
            deviations[:, colour] = sign * (near - 1)
            deviations[chance.permutation(pixels)[:count], colour] = sign * near
            await frame_of(device, deviations)
    for count in (half, half + 1):  # pixels above less pixels below
        deviations = np.full((pixels, 3), near)
        deviations[chance.permutation(pixels)[: (pixels - count) // 2]] = -near
        await frame_of(device, deviations)
    drop = (-(-2 * pixels // 3) - 1).bit_length() + light.deviation.fraction - (light.gain_width - 1)
    for target in (1, 3, -1, -3):  # odd multiples of half a step of the gain, and a last bit more or less
        for beside in (-1, 0, 1):
            total = (target << drop - 1) + beside
            deviations = np.full((pixels, 3), total // pixels)
            deviations[: total % pixels] += 1
            await frame_of(device, deviations)
    await device.check()


async def frame_of(device: Gains, deviations: np.ndarray) -> None:
    """Send a frame with these deviations in all rows but the last, by gains of 1, and any in the last row."""
    light = device.light
    await device.write(light.unity, 7)
    last = device.chance.integers(-light.near, light.near, (light.columns, 3))
    await device.send(device.of_deviations(np.concatenate((deviations, last)).reshape(device.shape)))


@on_bench(Gains, milliseconds=60)
async def gains_at_their_limits(device: Gains) -> None:
    """Send darkness and more light than a gain can follow: gains stop at their limits, deviations saturate."""
    largest = (1 << device.light.ratio_width) - 1
    for ratio in (largest, largest // 3, 1, 0):
        for _ in range(14):
            await device.send(np.full(device.shape, ratio))
    for step in (0, 1, -1):  # the move by one step of the gain at both limits
        for limit in (device.light.unity >> 1, 2 * device.light.unity - 1):
            await device.write(limit, 7)
            exact = round((device.light.unity << device.light.ratio_fraction) / limit)
            await device.send(np.full(device.shape, exact + step))
    await device.check()
    assert device.bench.saturations, "the test is void: nothing was clipped"


@on_bench(Gains, milliseconds=60)
@TRAFFIC
async def written(device: Gains) -> None:
    """Write gains of single colours at any time, also in the cycle of a frame's first and last pixel."""
    going_on = [True]

    async def writes() -> None:
        random = device.bench.random
        while going_on[0]:
            for _ in range(random.choice((1, 1, 3, len(device.places)))):
                await RisingEdge(device.dut.clk)
            await device.write(random.randrange(2 * device.light.unity), random.randrange(1, 8))

    writer = cocotb.start_soon(writes())
    for _ in range(device.frames):
        await device.send(device.picture(device.chance.uniform(0.8, 1.3, 3)))
    going_on[0] = False
    await writer
    await device.check()


@on_bench(Gains, milliseconds=60)
async def resets(device: Gains) -> None:
    """Reset inside a frame, malformed or not: nothing leaves, the gains are 1, and the next frame is right."""
    counts = (1, 2, 3, device.light.columns + 3, len(device.places) - 1)
    for index, count in enumerate(counts):
        await device.send(device.picture(1.2))
        await device.send(device.picture(1.2), bad=0 if index % 2 else None, pixels=count)
        await device.bench.reset(en=index % 2)
        device.forget()
        await device.bench.clocks(index % 2 * 4)
        assert not device.sink.starts, "a pixel left after a reset"
        await device.send(device.picture(1.2))
        await device.send(device.picture(1.2))
        await device.check()
        assert device.used[0].tolist() == 3 * [device.light.unity]
