# SPDX-License-Identifier: Apache-2.0
"""Tests that cores of bursts share: codes, latency, saturations; gaps, pauses, extremes, reset."""

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
    """A core whose words come in bursts of Beats, or of Size or Columns points, several words in a beat.

    Attributes
    ----------
    model : callable
        Takes the device, bursts (count, beats, paths, fields) and a Monitor, and returns bursts.
    latency : callable
        Takes the device, and returns the cycles from a start to its start out.
    width : str
        Parameter with the bits of a word going in.
    fields : sequence of str
        Of the words going in; out go the same, unless `ports` say others.
    ports : mapping
        Arguments of `check_bursts`.
    frame : callable
        Takes the device, and returns the bursts of a frame.
    """

    model: Callable[..., Any]
    latency: Callable[[Any], int]
    width: str = "Width"
    fields: Sequence[str] = ("re", "im")
    ports: Mapping[str, Any] = field(default_factory=dict)
    frame: Callable[[Any], int] = lambda dut: 3

    def shape(self, dut: Any, frames: int) -> tuple[int, ...]:
        """Return the shape of the bursts of so many frames."""
        (width,) = parameters(dut, self.width)
        paths = len(getattr(dut, f"in_{self.fields[0]}")) // width
        points = next(name for name in ("Beats", "Size", "Columns") if hasattr(dut, name))
        beats = parameters(dut, points)[0] // (1 if points == "Beats" else paths)
        return frames * self.frame(dut), beats, paths, len(self.fields)

    def words(self, dut: Any, frames: int, amplitude: float | None = 1.0) -> Any:
        """Return random bursts; see `uniform`."""
        (width,) = parameters(dut, self.width)
        return uniform(self.shape(dut, frames), width, amplitude)

    async def check(self, dut: Any, words: Any, **behaviour: Any) -> None:
        behaviour |= {**self.ports, "fields": self.fields, "frame": self.frame(dut)}
        await check_bursts(dut, words, partial(self.model, dut), self.latency(dut), **behaviour)

    def tests(self) -> tuple[Any, ...]:
        """Return the tests bursts, many_bursts, limits, reset_in_mid_burst and a_frame_begins_afresh."""

        @cocotb.test(name="bursts")
        @parametrize((("gap", "pause"), [(0, 0.0), (30, 0.0), (3, 0.0), (0, 0.3)]), amplitude=sample([0.01, 0.3, 1.0]))
        async def bursts(dut: Any, gap: int, pause: float, amplitude: float) -> None:
            await self.check(dut, self.words(dut, 3, amplitude), gap=gap, pause=pause)

        @cocotb.test(name="many_bursts")
        @parametrize(amplitude=[0.003, 0.1, None])
        async def many_bursts(dut: Any, amplitude: float) -> None:
            """Reach ties of every rounding, and clip every value that can clip."""
            await self.check(dut, self.words(dut, MANY, amplitude))

        @cocotb.test(name="limits")
        async def limits(dut: Any) -> None:
            """Fill a frame with each kind of burst."""
            (width,), (bursts, beats, paths, fields) = parameters(dut, self.width), self.shape(dut, 8)
            words = np.repeat(extremes(beats * paths, width, fields), bursts // 8, axis=0)
            await self.check(dut, words.reshape(bursts, beats, paths, fields))

        @cocotb.test(name="reset_in_mid_burst")
        @parametrize(where=["in", "out", "middle"], clips=[False, True])
        async def reset_in_mid_burst(dut: Any, where: str, clips: bool) -> None:
            """Reset as the first words enter or leave, or in the middle; a clip after it is not counted."""
            words = self.words(dut, 1, None if clips else 1.0)
            middle = words[..., 0, 0].size // 2
            first = {"in": 1, "out": max(1, self.latency(dut) - 3), "middle": middle}[where]
            await self.check(dut, words, interrupts=with_and_without_en(range(first, first + 12)))

        @cocotb.test(name="a_frame_begins_afresh")
        @parametrize(strays=[1, 2, 11])
        async def a_frame_begins_afresh(dut: Any, strays: int) -> None:
            """Start a frame after part of another one, and after more than one without a start of frame in between."""
            await self.check(dut, self.words(dut, 1, 0.1), strays=strays)

        return bursts, many_bursts, limits, reset_in_mid_burst, a_frame_begins_afresh
