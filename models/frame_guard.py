# SPDX-License-Identifier: Apache-2.0
"""Model of hdl/frame_guard.sv, word by word: any stream in, whole frames and faults out.

It knows no clock but that of silence: how long filler takes, and that the input waits meanwhile, changes
neither frames nor faults.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

FAULTS = ("row_short", "row_long", "start_missing", "start_early", "timed_out")


class Word(NamedTuple):
    """A word of AXI4-Stream Video."""

    data: int
    last: int
    user: int


@dataclass(frozen=True)
class Frame:
    """A frame that leaves.

    Attributes
    ----------
    pixels : tuple of int
        Raster order, rows * columns of them.
    bad : bool
        It was broken; the pixels from there on are filler.
    first, last : int
        Positions in the stream of the words that gave its first and its last pixel.
    """

    pixels: tuple[int, ...]
    bad: bool
    first: int
    last: int


@dataclass
class Guarded:
    """What leaves.

    Attributes
    ----------
    frames : list of Frame
    faults : list of str
        Of `FAULTS`, in the order of their clocks.
    open : list of int
        Pixels of a frame that is not complete at the end of the stream, and not broken either.
    """

    frames: list[Frame] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    open: list[int] = field(default_factory=list)


def frame_guard(stream: Iterable[Word | None], rows: int, columns: int, timeout: int = 0) -> Guarded:
    """Guard a stream.

    Parameters
    ----------
    stream : iterable of Word or None
        Words as they are taken. None: a clock in which the pipeline moves and the source offers nothing;
        these count only inside a frame and only with a `timeout`, so they may be left out without one.
    rows, columns : int
    timeout : int
        Clocks of silence inside a frame that are waited; the next one gives it up. 0: wait for ever.
    """
    out = Guarded()
    size = rows * columns
    first = last = silence = 0
    hunting = False  # the words to come are rest of a broken frame, or known to have no start

    def end(bad: bool) -> None:
        nonlocal hunting
        filler = [out.open[-1]] * (size - len(out.open))
        out.frames.append(Frame((*out.open, *filler), bad, first, last))
        out.open.clear()
        hunting = bad

    def fault(name: str) -> None:
        out.faults.append(name)
        end(bad=True)

    for position, word in enumerate(stream):
        if word is None:
            if out.open and timeout and silence >= timeout:
                fault("timed_out")
            silence += 1
            continue
        silence = 0
        if out.open and word.user:
            fault("start_early")
        if not out.open:
            if not word.user:
                if not hunting:
                    out.faults.append("start_missing")
                hunting = True
                continue
            first = position
        last = position
        out.open.append(word.data)
        row_is_full = len(out.open) % columns == 0
        if word.last != row_is_full:
            fault("row_short" if word.last else "row_long")
        elif len(out.open) == size:
            end(bad=False)
    return out
