# SPDX-License-Identifier: Apache-2.0
"""Model of hdl/video/frame_guard.sv, word by word: any stream in, complete frames and faults out.

The model counts cycles only for the time-out. It leaves out the cycles in which filler is sent and the input waits;
these change neither frames nor faults.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

LATENCY = 1

FAULTS = ("row_short", "row_long", "start_missing", "start_early", "timed_out")


class Word(NamedTuple):
    """A word of AXI4-Stream Video."""

    data: int
    last: int
    user: int


@dataclass(frozen=True)
class Frame:
    """A frame at the output.

    Attributes
    ----------
    pixels : tuple of int
        All rows * columns pixels in raster order.
    bad : bool
        True if the frame was broken; the pixels after the fault are filler.
    first, last : int
        Positions in the stream of the words of the first and of the last pixel.
    """

    pixels: tuple[int, ...]
    bad: bool
    first: int
    last: int


@dataclass
class Guarded:
    """Output of the guard.

    Attributes
    ----------
    frames : list of Frame
    faults : list of str
        Names from `FAULTS`, in the order of the cycles.
    open : list of int
        Pixels of a frame that is incomplete at the end of the stream, and not broken.
    """

    frames: list[Frame] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    open: list[int] = field(default_factory=list)


def frame_guard(stream: Iterable[Word | None], rows: int, columns: int, timeout: int = 0) -> Guarded:
    """Return the complete frames and the faults of a stream.

    Parameters
    ----------
    stream : iterable of Word or None
        Words in the order in which they are taken. None stands for a cycle in which the pipeline moves and the source
        offers nothing. Such cycles count only inside a frame and with a `timeout`; otherwise they may be left out.
    rows, columns : int
    timeout : int
        Cycles of silence allowed inside a frame; the frame is given up in the next one. 0: no limit.
    """
    out = Guarded()
    size = rows * columns
    first = last = silence = 0
    hunting = False  # the next words belong to a broken frame, or have no start of frame

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
