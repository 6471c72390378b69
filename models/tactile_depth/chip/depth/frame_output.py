# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/depth/frame_output.sv: turns the solver's output into the beats of good frames."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple


class Clock(NamedTuple):
    """Inputs in one enabled cycle; `bad` matters only if `due` is set."""

    start: bool
    frame_start: bool
    data: int
    due: bool
    bad: bool


@dataclass
class FrameOutput:
    """Output and marks.

    Attributes
    ----------
    beats : list of tuple of int
        Data, row_end, frame_start.
    clocks : list of int
        Enabled cycle of each beat, counted from 0.
    ends : list of int
        Enabled cycles of the last words of frames, good or bad.
    out_of_step : list of int
        Enabled cycles in which the start of a burst or of a frame was missing or unexpected.
    """

    beats: list[tuple[int, int, int]] = field(default_factory=list)
    clocks: list[int] = field(default_factory=list)
    ends: list[int] = field(default_factory=list)
    out_of_step: list[int] = field(default_factory=list)


def frame_output(inputs: Iterable[Clock], rows: int, columns: int) -> FrameOutput:
    """Return beats and marks for the inputs of successive enabled cycles after a reset."""
    out, position, bad = FrameOutput(), rows * columns, False
    for clock, word in enumerate(inputs):
        if word.due:
            position, bad = 0, word.bad or not word.frame_start
        active = position < rows * columns
        column = position % columns
        if (word.start, word.frame_start) != (active and column == 0, word.due):
            out.out_of_step.append(clock)
        if active:
            if not bad:
                out.beats.append((word.data, int(column == columns - 1), int(word.due)))
                out.clocks.append(clock)
            position += 1
            if position == rows * columns:
                out.ends.append(clock)
    return out
