# SPDX-License-Identifier: Apache-2.0
"""black_level against its model: limits and random samples, settings that change in every cycle, pauses, resets."""

from typing import Any

import numpy as np

from formal.entries import FULL_WIDTH, Proof
from tactile_depth.chip.camera.black_level import LATENCY, black_level
from tb.camera.slots import Slot, Slots, packed, unpacked
from tb.cases import on_bench
from tb.stream import MANY, drive, parameters, parametrize
from tb.structures import BOTH, ICARUS, Mutants, of_parameters

built = of_parameters("Bits Channels")
STRUCTURES = (
    built(10, 1, on=BOTH, mutants=ICARUS),
    built(8, 3, on=ICARUS, mutants=ICARUS),
    built(12, 1),
    built(10, 3),
    built(8, 1),
)
PROTOCOL = {
    "begun": {"begins": "en & in_valid"},
    "holds": "rst | ~in_valid | begun | in_frame_start",
    "counts": "live & ~reset",
    "out_samples out_colour out_row_start out_frame_start out_gains": "counts & out_valid",
}
MUTANTS = Mutants(repeats=2)
PROOFS = tuple(
    Proof(
        FULL_WIDTH,
        {"Bits": bits, "Channels": channels},
    )
    for bits, channels in ((10, 1), (8, 3))
)


OUTPUTS = ["out_valid", "out_samples", "out_colour", "out_row_start", "out_frame_start", "out_abort", "out_gains"]


class Bench:
    def __init__(self, dut: Any) -> None:
        self.dut = dut
        self.bits, self.channels, gains_width = parameters(dut, "Bits", "Channels", "GainsWidth")
        self.width = self.bits + 2
        pins = {"in_samples": self.channels * self.width, "in_colour": 2, "in_row_start": 1, "in_frame_start": 1}
        self.slots = Slots(pins | {"level": self.bits, "gains": gains_width})
        self.stimuli: list[Slot] = []

    def samples(self) -> int:
        """Return samples from which the largest black level can be taken within their bits."""
        chance, low, high = self.slots.random, (1 << self.bits) - 1 - (1 << self.width - 1), (1 << self.width - 1) - 1
        values = [
            chance.choice((low, high, 0, 1, -1, chance.randint(low, high), chance.getrandbits(self.bits)))
            for _ in range(self.channels)
        ]
        return packed(values, self.width)

    def frame(self, pixels: int, gap: float = 0.0) -> None:
        chance, largest = self.slots.random, (1 << self.bits) - 1
        words = [{"in_samples": self.samples(), "in_frame_start": int(place == 0)} for place in range(pixels)]
        words[0] |= {"level": chance.choice((0, largest, chance.getrandbits(self.bits)))}
        self.stimuli += self.slots.apart(words, gap)

    def expected(self, pin_values: Any) -> list[Any]:
        """Return what was taken in each cycle: None, "abort", or samples, colour, marks and gains."""
        out: list[Any] = []
        level = gains = 0
        for clock in range(len(self.stimuli)):
            pins = {name: int(values[clock]) for name, values in pin_values.items() if not name.startswith("out_")}
            word: Any = None
            if pins["in_valid"] and pins["in_frame_start"]:  # in a reset too
                level, gains = pins["level"], pins["gains"]
            if pins["in_abort"] and not pins["rst"]:
                word = "abort"
            elif pins["in_valid"] and not pins["rst"]:
                samples = np.array(unpacked(pins["in_samples"], self.width, self.channels))
                marks = (pins["in_colour"], pins["in_row_start"], pins["in_frame_start"])
                word = (black_level(samples, level).tolist(), *marks, gains)
            out.append(word)
        return out

    async def check(self, pause: float = 0.0) -> None:
        self.stimuli += [self.slots.idle() for _ in range(LATENCY + 1)]
        pin_values = await drive(self.dut, self.stimuli, OUTPUTS, pause)
        for clock, want in enumerate(self.expected(pin_values)[:-LATENCY], LATENCY):
            got: Any = "abort" if int(pin_values["out_abort"][clock]) else None
            if int(pin_values["out_valid"][clock]):
                samples = unpacked(pin_values["out_samples"][clock], self.width, self.channels)
                names = ("out_colour", "out_row_start", "out_frame_start", "out_gains")
                got = (samples, *(int(pin_values[name][clock]) for name in names))
            assert got == want, f"clock {clock}"


@on_bench(Bench, milliseconds=2)
@parametrize((("gap", "pause"), [(0.0, 0.0), (0.4, 0.0), (0.2, 0.3)]))
async def frames(bench: Bench, gap: float, pause: float) -> None:
    for _ in range(50 * MANY):
        bench.frame(bench.slots.random.choice((1, 2, 9, 30)), gap)
        if bench.slots.random.random() < 0.3:
            bench.stimuli.append(bench.slots.idle(in_abort=1))
    await bench.check(pause)


@on_bench(Bench, milliseconds=2)
async def resets(bench: Bench) -> None:
    for age in range(1, 6):
        bench.frame(age)
        if age % 2:
            bench.stimuli.append(bench.slots.idle(in_abort=1))
        for offered in ({}, {"in_valid": 1}, {"in_abort": 1}):  # nothing leaves of what comes in a reset
            bench.stimuli.append(bench.slots.idle(rst=1, **offered))
    bench.frame(9)
    await bench.check()
