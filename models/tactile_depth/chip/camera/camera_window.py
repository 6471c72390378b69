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


def camera_window(
    stream: Iterable[tuple[Word, Settings]],
    window: tuple[int, int],
    words_per_pixel: int = 1,
    pixel_pairs: bool = False,
) -> Watched:
    """Return the pixels of the pictures in a stream, the breaks, and the faults.

    Parameters
    ----------
    stream : iterable of (Word, Settings)
        Words in the order in which they are taken, each with the settings of the cycle before.
    window : (width, height)
    words_per_pixel : int
        Words that make a pixel; their lowest bytes are put together, the first below.
    pixel_pairs : bool
        Two columns share a word, so both pixels of a pair are needed if one is in the window.
    """
    seen = Watched()
    width, height = window
    row = column = 0
    now: Settings | None = None  # of the present picture
    hunting = passed = False
    held: list[int] = []  # bytes of a pixel that is not complete

    def close(is_broken: bool) -> None:
        nonlocal now, row, column, hunting, passed
        now, row, column, passed, hunting = None, 0, 0, False, is_broken
        held.clear()

    def fault(position: int, name: str) -> None:
        if not passed:
            seen.faults.append((position, name))
            seen.out.append((position, None))
        close(is_broken=True)

    for position, (word, settings) in enumerate(stream):
        if now is not None and word.user:
            fault(position, "start_early")
        if now is None:
            if not word.user:
                if not hunting:
                    fault(position, "start_missing")
                continue
            now, hunting = settings, False
            usable = now.columns - now.columns % 2 if pixel_pairs else now.columns
            if now.x + width > usable or now.y + height > now.rows:
                fault(position, "window_outside")
                continue
        held.append(word.data)
        is_complete = len(held) == words_per_pixel
        row_ends = is_complete and column == now.columns - 1
        if bool(word.last) != row_ends:
            fault(position, "row_short" if word.last else "row_long")
            continue
        if not is_complete:
            continue
        data = held[0] if words_per_pixel == 1 else sum((byte & 255) << 8 * place for place, byte in enumerate(held))
        held.clear()
        right, bottom = now.x + width - 1, now.y + height - 1
        starts = column == now.x
        inside = now.x <= column <= right and now.y <= row <= bottom
        seen.out.append((position, Pixel(data, row, column, inside, starts, starts and row == now.y)))
        passed = passed or (row == bottom and column == (right | 1 if pixel_pairs else right))
        row, column = (row + 1, 0) if row_ends else (row, column + 1)
        if row == now.rows:
            close(is_broken=False)
    return seen
