# SPDX-License-Identifier: Apache-2.0
"""channel_gain against its model: limits and random samples, settings that change in every cycle, pauses, resets."""

from typing import Any

import cocotb
import numpy as np

from tactile_depth.camera.channel_gain import channel_gain
from tactile_depth.camera_configuration import GAIN_FRACTION, GAIN_WIDTH
from tactile_depth.latency import CHANNEL_GAIN
from tb.camera.slots import Slot, Slots, packed, unpacked
from tb.stream import MANY, drive, parameters

OUTPUTS = ["out_valid", "out_samples", "out_colour", "out_row_start", "out_frame_start", "out_abort"]
GAINS = ("red_gain", "green_gain", "blue_gain")
COLOUR_OF_SITE = (0, 1, 1, 2)


class Bench:
    def __init__(self, dut: Any) -> None:
        self.dut = dut
        self.bits, self.bayer = parameters(dut, "Bits", "Bayer")
        self.width, self.channels = self.bits + 2, 1 if self.bayer else 3
        pins = {"in_samples": self.channels * self.width, "in_colour": 2, "in_row_start": 1, "in_frame_start": 1}
        self.slots = Slots(pins | {"black_level": self.bits, **dict.fromkeys(GAINS, GAIN_WIDTH)})
        self.stimuli: list[Slot] = []

    def settings(self) -> Slot:
        """Return settings of a frame: neutral, at their limits, or random."""
        chance = self.slots.random
        one, most = 1 << GAIN_FRACTION, (1 << GAIN_WIDTH) - 1
        if chance.random() < 0.2:
            return {"black_level": 0, **dict.fromkeys(GAINS, one)}
        gains = {gain: chance.choice((0, one, most, chance.getrandbits(GAIN_WIDTH), one // 2)) for gain in GAINS}
        return {"black_level": chance.choice((0, (1 << self.bits) - 1, chance.getrandbits(self.bits))), **gains}

    def samples(self) -> int:
        chance, limit = self.slots.random, 1 << self.width - 1
        limits = (-limit, limit - 1, 0, 1, -1)
        values = [
            chance.choice((*limits, chance.randrange(-limit, limit), chance.getrandbits(self.bits)))
            for _ in range(self.channels)
        ]
        return packed(values, self.width)

    def frame(self, pixels: int, gap: float = 0.0) -> None:
        words = [{"in_samples": self.samples(), "in_frame_start": int(place == 0)} for place in range(pixels)]
        words[0] |= self.settings()
        self.stimuli += self.slots.apart(words, gap)

    def expected(self, pin_values: Any) -> list[Any]:
        """Return what was taken in each cycle: None, "abort", or samples, colour and marks."""
        out: list[Any] = []
        black, gains = 0, np.zeros(3, np.int64)
        for clock in range(len(self.stimuli)):
            word: Any = None
            if pin_values["rst"][clock]:
                out[-CHANNEL_GAIN + 1 :] = [None] * min(len(out), CHANNEL_GAIN - 1)
            elif pin_values["in_abort"][clock]:
                word = "abort"
            elif pin_values["in_valid"][clock]:
                if pin_values["in_frame_start"][clock]:
                    black = int(pin_values["black_level"][clock])
                    gains = np.array([int(pin_values[gain][clock]) for gain in GAINS])
                samples = np.array(unpacked(pin_values["in_samples"][clock], self.width, self.channels))
                colour = int(pin_values["in_colour"][clock])
                factor = gains[[COLOUR_OF_SITE[colour]]] if self.bayer else gains
                marks = [int(pin_values[f"in_{mark}"][clock]) for mark in ("row_start", "frame_start")]
                word = (channel_gain(samples, black, factor, self.width).tolist(), colour, *marks)
            out.append(word)
        return out

    async def check(self, pause: float = 0.0) -> None:
        self.stimuli += [self.slots.idle() for _ in range(CHANNEL_GAIN + 1)]
        pin_values = await drive(self.dut, self.stimuli, OUTPUTS, pause)
        for clock, want in enumerate(self.expected(pin_values)[:-CHANNEL_GAIN], CHANNEL_GAIN):
            got: Any = "abort" if int(pin_values["out_abort"][clock]) else None
            if int(pin_values["out_valid"][clock]):
                samples = unpacked(pin_values["out_samples"][clock], self.width, self.channels)
                marks = [int(pin_values[f"out_{mark}"][clock]) for mark in ("row_start", "frame_start")]
                got = (samples, int(pin_values["out_colour"][clock]), *marks)
            assert got == want, f"clock {clock}"


@cocotb.test(timeout_time=2, timeout_unit="ms")
@cocotb.parametrize((("gap", "pause"), [(0.0, 0.0), (0.4, 0.0), (0.2, 0.3)]))
async def frames(dut: Any, gap: float, pause: float) -> None:
    bench = Bench(dut)
    for _ in range(50 * MANY):
        bench.frame(bench.slots.random.choice((1, 2, 9, 30)), gap)
        if bench.slots.random.random() < 0.3:
            bench.stimuli.append(bench.slots.idle(in_abort=1))
    await bench.check(pause)


@cocotb.test(timeout_time=2, timeout_unit="ms")
async def resets(dut: Any) -> None:
    bench = Bench(dut)
    for age in range(1, 3 * CHANNEL_GAIN):
        bench.frame(age)
        if age % 2:
            bench.stimuli.append(bench.slots.idle(in_abort=1))
        bench.stimuli.append(bench.slots.idle(rst=1))
    bench.frame(9)
    await bench.check()
