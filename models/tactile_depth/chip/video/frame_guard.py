# SPDX-License-Identifier: Apache-2.0
"""Model of hdl/video/frame_guard.sv: any stream in, complete frames and faults out."""

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
    resumed : bool
        Words were dropped before it, or the frame before it was broken.
    """

    pixels: tuple[int, ...]
    bad: bool
    first: int
    last: int
    resumed: bool = False


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
    hunting : bool
        Words are dropped up to the next start of frame at the end of the stream.
    """

    frames: list[Frame] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    open: list[int] = field(default_factory=list)
    hunting: bool = False


@dataclass
class FrameGuard:
    """State of the core.

    Attributes
    ----------
    rows, columns : int
    pixels : list of int
        Of the present frame, as they leave.
    filling, hunting : bool
        A broken frame is filled up; words up to the next start are dropped and not flagged, but for those of a
        self-test.
    silence, expired : int, bool
        Cycles without a word inside a frame; they have reached the timeout of the last of them.
    out : dict
        Pins of the pixel that leaves, if one does.
    """

    rows: int
    columns: int
    pixels: list[int] = field(default_factory=list)
    filling: bool = False
    hunting: bool = False
    silence: int = 0
    expired: bool = False
    out: dict[str, int] = field(default_factory=dict)

    def _leave(self, data: int, bad: bool, is_test: bool = False) -> None:
        row, column = divmod(len(self.pixels), self.columns)
        self.pixels.append(data)
        starts, ends = (row == 0, column == 0), (row == self.rows - 1, column == self.columns - 1)
        position = sum(mark << bit for bit, mark in enumerate((*starts, *ends)))
        self.out = {"out_valid": 1, "out_data": data, "out_position": position, "out_frame_start": all(starts)}
        self.filling = bad and not all(ends)
        if all(ends) and not is_test:
            self.hunting = bad
        if all(ends):
            self.out |= {"out_frame_end": 1, "out_bad": bad or is_test, "out_test": is_test}
            self.pixels = []

    def fill(self, is_test: bool = False) -> None:
        """Let a pixel of filler leave."""
        self.silence = 0
        self._leave(self.pixels[-1], True, is_test)

    def take(self, word: Word | None, timeout: int = 0, is_test: bool = False) -> str:
        """Take a word, None for silence, while no frame is filled up; return the fault that it shows.

        An early start is not taken: it breaks the frame, and then begins the next.
        """
        self.out, fault = {}, ""
        waited, self.silence, self.filling, self.expired = self.silence, 0, self.expired, False
        if word is None and self.pixels:
            self.silence = waited + 1
            self.expired = 0 < timeout <= self.silence
            return "timed_out" if self.filling else ""
        self.filling = False
        if word is None:
            return ""
        if self.pixels and word.user:
            self.filling = True
            return "start_early"
        if not self.pixels and not word.user:
            fault, self.hunting = "" if self.hunting else "start_missing", self.hunting or not is_test
            return fault
        if word.last != (len(self.pixels) % self.columns == self.columns - 1):
            fault = "row_short" if word.last else "row_long"
        self.hunting &= is_test
        self._leave(word.data, bool(fault), is_test)
        return fault

    def clock(self, **pins: int) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it that count."""
        between, left = not self.pixels, self.rows * self.columns - len(self.pixels)
        ready = pins["en"] and (between or not pins["s_user"])
        marks: dict[str, int] = {"between": between, "row_ends": left % self.columns == 1, "frame_ends": left == 1}
        marks |= {"out_valid": 0, "out_frame_start": 0, "out_frame_end": 0, "hunting": self.hunting}
        out, fault = marks | self.out, ""
        if pins["en"] and self.filling:
            self.fill(bool(pins["s_test"]))
        elif pins["en"]:
            word = Word(pins["s_data"], pins["s_last"], pins["s_user"]) if pins["s_valid"] else None
            fault = self.take(word, pins["timeout"], bool(pins["s_test"]))
        if pins["rst"]:
            self.pixels, self.filling, self.hunting, self.silence, self.out = [], False, False, 0, {}
            self.expired = False
        return {"s_ready": ready, "faults": sum((name == fault) << bit for bit, name in enumerate(FAULTS)), **out}


def frame_guard(stream: Iterable[Word | None], rows: int, columns: int, timeout: int = 0) -> Guarded:
    """Return the complete frames and the faults of a stream.

    The cycles in which filler is sent and the input waits are left out; these change neither frames nor faults.

    Parameters
    ----------
    stream : iterable of Word or None
        Words in the order in which they are taken. None stands for a cycle in which the pipeline moves and the source
        offers nothing. Such cycles count only inside a frame and with a `timeout`; otherwise they may be left out.
    rows, columns : int
    timeout : int
        Cycles of silence allowed inside a frame; the frame is given up in the next one. 0: no limit.
    """
    seen, core, first, last, resumed = Guarded(), FrameGuard(rows, columns), 0, 0, False
    for position, word in enumerate(stream):
        fault = "start_early"
        while fault == "start_early":
            hunted = core.hunting
            fault = core.take(word, timeout)
            seen.faults += [fault] if fault else []
            if core.out:
                first, resumed = (position, hunted) if core.out["out_frame_start"] else (first, resumed)
                last = position
                seen.open.append(core.out["out_data"])
            while core.filling:
                core.fill()
                seen.open.append(core.out["out_data"])
            if "out_bad" in core.out:
                seen.frames.append(Frame(tuple(seen.open), bool(core.out["out_bad"]), first, last, resumed))
                seen.open = []
    seen.hunting = core.hunting
    return seen
