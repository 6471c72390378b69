# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/frame_output.sv: what the solver puts out, and when; the beats of good frames."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple


class Clock(NamedTuple):
    """The inputs in one enabled clock: in_bad counts where in_due is true."""

    start: bool
    frame_start: bool
    data: int
    due: bool
    bad: bool


@dataclass
class FrameOutput:
    """What leaves.

    Attributes
    ----------
    beats : list of tuple of int
        data, last (of a row), user (first of a frame).
    clocks : list of int
        Enabled clock of each beat, from 0.
    ends : list of int
        Clocks of the last words of frames, good or bad.
    out_of_step : list of int
        Clocks in which a burst or a frame did not begin where it should, or began where it should not.
    """

    beats: list[tuple[int, int, int]] = field(default_factory=list)
    clocks: list[int] = field(default_factory=list)
    ends: list[int] = field(default_factory=list)
    out_of_step: list[int] = field(default_factory=list)


def frame_output(inputs: Iterable[Clock], rows: int, columns: int) -> FrameOutput:
    """Beats and marks for the inputs of successive enabled clocks after a reset."""
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
