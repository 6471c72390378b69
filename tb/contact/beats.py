# SPDX-License-Identifier: Apache-2.0
"""Choices of depths that leave together, of thresholds near them, and marks of frames."""

import random
from typing import Any

import cocotb

from tactile_depth.chip.fixed_point import joined
from tb.lockstep import Pins
from tb.stream import depth_position, parameters


def levels(width: int, bits: int) -> list[int]:
    """Return codes of a width at and beside its limits and powers of two, 0 first, as words of so many bits."""
    limits = [0, *(sign << bit for bit in range(width) for sign in (1, -1))]
    beside = [code + step for code in limits for step in (0, -1, 1)]
    return [code % (1 << bits) for code in beside if -1 << bits - 1 <= code < 1 << bits - 1]


def beats(width: int, lanes: int) -> list[int]:
    """Return beats of depths: lowest but for one, of few values, and any; the first are all 0."""
    chance = random.Random(cocotb.RANDOM_SEED)
    made, lowest = [[0] * lanes], 1 << width - 1
    for code in levels(width, width):
        lone = [lowest] * lanes
        lone[chance.randrange(lanes)] = code
        few = chance.choices([code, *chance.choices(levels(width, width), k=2)], k=lanes)
        made += [lone, [code] * lanes, few, [chance.getrandbits(width) for _ in range(lanes)]]
    return [joined(beat, width) for beat in made]


class Frames:
    """Marks of the beats of frames, some of which begin inside others."""

    def __init__(self, dut: Any) -> None:
        rows, columns, lanes = parameters(dut, "Rows", "Columns", "Lanes")
        self.row, self.beats, self.place = columns // lanes, rows * columns // lanes, 0

    def __call__(self, model: Any, pins: Pins) -> None:
        if pins.pop("interrupts"):
            self.place = 0
        end = self.place + 1
        pins["in_position"] = depth_position(self.place == 0, end % self.row == 0, end == self.beats)
        if pins["in_valid"]:
            self.place = end % self.beats
        if pins["rst"]:
            self.place = 0
