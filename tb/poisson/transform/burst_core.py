# SPDX-License-Identifier: Apache-2.0
"""Tests that the cores of a transform share: codes, latency, saturations; gaps, pauses, extremes, reset."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import cocotb
import numpy as np

from tb.beats import check_bursts
from tb.stream import MANY, extremes, parameters, parametrize, sample, uniform, with_and_without_en


@dataclass(frozen=True)
class BurstCore:
    """A core whose words come in bursts of Beats, or Size points, several words in a beat.

    Attributes
    ----------
    model : callable
        Takes the device, bursts (count, beats, paths, fields) and a Monitor, and returns bursts.
    latency : callable
        Takes the device, and returns the cycles from a start to its start out.
    width : str
        Parameter with the bits of a word going in.
    ports : mapping
        Arguments of `check_bursts`.
    """

    model: Callable[..., Any]
    latency: Callable[[Any], int]
    width: str = "Width"
    fields: Sequence[str] = ("re", "im")
    ports: Mapping[str, Any] = field(default_factory=dict)

    def shape(self, dut: Any, count: int) -> tuple[int, ...]:
        """Return the shape of so many bursts."""
        (width,) = parameters(dut, self.width)
        paths = len(getattr(dut, f"in_{self.fields[0]}")) // width
        (beats,) = parameters(dut, "Beats") if hasattr(dut, "Beats") else np.array(parameters(dut, "Size")) // paths
        return count, int(beats), paths, len(self.fields)

    def words(self, dut: Any, count: int, amplitude: float | None = 1.0) -> Any:
        """Return random bursts; see `uniform`."""
        (width,) = parameters(dut, self.width)
        return uniform(self.shape(dut, count), width, amplitude)

    async def check(self, dut: Any, words: Any, **behaviour: Any) -> None:
        behaviour |= self.ports
        await check_bursts(dut, words, partial(self.model, dut), self.latency(dut), fields=self.fields, **behaviour)

    def tests(self) -> tuple[Any, ...]:
        """Return the tests bursts, many_bursts, limits and reset_in_mid_burst."""

        @cocotb.test(name="bursts")
        @parametrize((("gap", "pause"), [(0, 0.0), (30, 0.0), (3, 0.0), (0, 0.3)]), amplitude=sample([0.3, 1.0, None]))
        async def bursts(dut: Any, gap: int, pause: float, amplitude: float) -> None:
            await self.check(dut, self.words(dut, 8, amplitude), gap=gap, pause=pause)

        @cocotb.test(name="many_bursts")
        @parametrize(amplitude=[0.1, None])
        async def many_bursts(dut: Any, amplitude: float) -> None:
            """Reach ties of every rounding, and clip every value that can clip."""
            await self.check(dut, self.words(dut, 4 * MANY, amplitude))

        @cocotb.test(name="limits")
        async def limits(dut: Any) -> None:
            (width,), shape = parameters(dut, self.width), self.shape(dut, 8)
            words = extremes(shape[1] * shape[2], width, shape[3])
            await self.check(dut, words.reshape(shape))

        @cocotb.test(name="reset_in_mid_burst")
        @parametrize((("late", "clips"), sample([(False, True), (False, False), (True, False), (True, True)])))
        async def reset_in_mid_burst(dut: Any, late: bool, clips: bool) -> None:
            """Reset in each cycle in which a burst begins to enter, or to leave; a clip after it is not counted."""
            first = max(1, self.latency(dut) - 3) if late else 1
            words = self.words(dut, 2, None if clips else 1.0)
            await self.check(dut, words, interrupts=with_and_without_en(range(first, first + 12)))

        return bursts, many_bursts, limits, reset_in_mid_burst
