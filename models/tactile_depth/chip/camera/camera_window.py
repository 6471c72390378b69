# SPDX-License-Identifier: Apache-2.0
"""Model of hdl/camera/camera_window.sv, word by word: any stream in, pixels of pictures and faults out."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

from tactile_depth.chip.video.frame_guard import Word

LATENCY = 1

FAULTS = ("row_short", "row_long", "start_missing", "start_early", "window_outside")


class Settings(NamedTuple):
    """Settings of a picture: its size, and the window's first pixel."""

    columns: int
    rows: int
    x: int
    y: int


class Pixel(NamedTuple):
    """A pixel of a picture."""

    data: int
    row: int
    column: int
    inside: bool
    row_start: bool
    frame_start: bool


@dataclass
class Watched:
    """Output of the core.

    Attributes
    ----------
    out : list of (int, Pixel or None)
        Position of a word in the stream, and the pixel that it completes; None: the picture is broken.
    faults : list of (int, str)
        Position of the word that shows a fault, and its name.
    """

    out: list[tuple[int, Pixel | None]] = field(default_factory=list)
    faults: list[tuple[int, str]] = field(default_factory=list)


@dataclass
class CameraWindow:
    """State of the core.

    Attributes
    ----------
    window : (width, height)
    words_per_pixel : int
        Words that make a pixel; their lowest bytes are put together, the first below.
    pixel_pairs : bool
        Two columns share a word, so both pixels of a pair are needed if one is in the window.
    row, column : int
        Of the pixel that comes next; 0 between pictures.
    now : Settings or None
        Settings of the present picture.
    hunting, passed : bool
        Words up to the next start are dropped and not flagged; the window's last pixel was taken.
    held : list of int
        Words of a pixel that is not complete.
    before : Settings or None
        Settings in the clock before.
    """

    window: tuple[int, int]
    words_per_pixel: int = 1
    pixel_pairs: bool = False
    row: int = 0
    column: int = 0
    now: Settings | None = None
    hunting: bool = False
    passed: bool = False
    held: list[int] = field(default_factory=list)
    before: Settings | None = None
    _out: tuple[Pixel | None, bool] = (None, False)

    @property
    def row_ends(self) -> bool:
        """True if the next word of the picture is the last of its row."""
        return self.now is not None and (
            (self.column, len(self.held)) == (self.now.columns - 1, self.words_per_pixel - 1)
        )

    def _close(self, hunting: bool) -> None:
        self.now, self.row, self.column, self.passed, self.hunting = None, 0, 0, False, hunting
        self.held.clear()

    def take(self, word: Word, settings: Settings) -> tuple[Pixel | None, str]:
        """Take a word; return the pixel that it completes, and the fault that it shows.

        An early start is not taken: it breaks the picture, and then begins the next.
        """
        fault = ""
        width, height = self.window
        if self.now is not None and word.user:
            fault = "start_early"
        elif self.now is None and not word.user:
            if not self.hunting:
                fault = "start_missing"
        elif self.now is None:
            self.now, self.hunting = settings, False
            usable = settings.columns - settings.columns % 2 if self.pixel_pairs else settings.columns
            if settings.x + width > usable or settings.y + height > settings.rows:
                fault = "window_outside"
        if self.now is None and not fault:
            return None, ""
        row_ends = self.row_ends
        if not fault and bool(word.last) != row_ends:
            fault = "row_short" if word.last else "row_long"
        if fault:
            shown = "" if self.passed else fault
            self._close(hunting=True)
            return None, shown
        assert self.now is not None
        now, row, column = self.now, self.row, self.column
        self.held.append(word.data)
        if len(self.held) < self.words_per_pixel:
            return None, ""
        data = word.data if self.words_per_pixel == 1 else int.from_bytes([held & 255 for held in self.held], "little")
        self.held.clear()
        right, bottom = now.x + width - 1, now.y + height - 1
        starts = column == now.x
        inside = now.x <= column <= right and now.y <= row <= bottom
        self.passed |= row == bottom and column == (right | 1 if self.pixel_pairs else right)
        self.row, self.column = (row + 1, 0) if row_ends else (row, column + 1)
        if self.row == now.rows:
            self._close(hunting=False)
        return Pixel(data, row, column, inside, starts, starts and row == now.y), ""

    def clock(self, **pins: int) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        settings = Settings(pins["columns"], pins["rows"], pins["window_x"], pins["window_y"])
        pixel, abort = self._out
        out: dict[str, int | None] = {
            "s_ready": pins["en"] and not (self.now and pins["s_user"]),
            "out_valid": pixel is not None,
            "out_abort": abort,
            "hunting": self.hunting,
        }
        if pixel is not None:
            out |= {"out_data": pixel.data, "out_odd_row": pixel.row % 2, "out_odd_column": pixel.column % 2}
            out["out_inside"] = pixel.inside
            if pixel.inside:
                out |= {"out_row_start": pixel.row_start, "out_frame_start": pixel.frame_start}
        shown = ""
        if pins["en"]:
            pixel = None
            if pins["s_valid"]:
                pixel, shown = self.take(Word(pins["s_data"], pins["s_last"], pins["s_user"]), self.before or settings)
            self._out = pixel, bool(shown)
        self.before = settings
        if pins["rst"]:
            self._close(hunting=False)
            self._out = None, False
        return out | {fault: fault == shown for fault in FAULTS}


def camera_window(
    stream: Iterable[tuple[Word, Settings]],
    window: tuple[int, int],
    words_per_pixel: int = 1,
    pixel_pairs: bool = False,
) -> Watched:
    """Return the pixels of the pictures in a stream, the breaks, and the faults.

    The stream is of words in the order in which they are taken, each with the settings of the cycle before.
    """
    seen, core = Watched(), CameraWindow(window, words_per_pixel, pixel_pairs)
    for position, (word, settings) in enumerate(stream):
        for _ in range(1 + bool(core.now and word.user)):
            pixel, fault = core.take(word, settings)
            seen.out += [(position, pixel)] if pixel or fault else []
            seen.faults += [(position, fault)] if fault else []
    return seen
