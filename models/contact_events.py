# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/contact_events.sv: the record of each frame, beat by beat; its packets, clock by clock."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from models.round_saturate import round_half_even

FRACTION = 4  # bits of a centroid below a pixel
WORD_BITS = 32
TOUCHING, BEGAN, ENDED = 1, 2, 4  # bits of word 0
CLOCKS_TO_TOUCHING = 3  # from the last depth of a frame


class Settings(NamedTuple):
    """The registers, as they stand with the first depth of a frame."""

    on_threshold: int
    off_threshold: int
    minimum_area: int
    debounce: int


class Record(NamedTuple):
    """What is known of a frame when it has left. Places are (row, column), rows counted from the picture's top."""

    status: int
    frame: int
    time: int
    area: int = 0
    peak: int = 0
    peak_place: tuple[int, int] = (0, 0)
    least: tuple[int, int] = (0, 0)
    greatest: tuple[int, int] = (0, 0)
    column_sum: int = 0
    row_sum: int = 0
    volume: int = 0
    centroid: tuple[int, int] = (0, 0)  # of 2**-FRACTION pixels

    @property
    def words(self) -> tuple[int, ...]:
        """As they leave."""
        volume = self.volume % (1 << 2 * WORD_BITS)
        return (
            self.status,
            self.frame,
            self.time,
            self.area,
            self.peak % (1 << WORD_BITS),
            _place(self.peak_place),
            _place(self.least),
            _place(self.greatest),
            self.column_sum,
            self.row_sum,
            volume % (1 << WORD_BITS),
            volume >> WORD_BITS,
            _place(self.centroid),
        )


def _place(place: tuple[int, int]) -> int:
    return place[0] << 16 | place[1]


def _signed(word: int, bits: int) -> int:
    return word - (word >> bits - 1 << bits)


WORDS = len(Record(0, 0, 0).words)


def record(words: Sequence[int]) -> Record:
    """Read the words of a packet, or of the registers."""

    def place(word: int) -> tuple[int, int]:
        return word >> 16, word & 0xFFFF

    status, frame, time, area, peak, peak_place, least, greatest, column_sum, row_sum, low, high, centroid = words
    volume = _signed(high << WORD_BITS | low, 2 * WORD_BITS)
    places = place(peak_place), place(least), place(greatest)
    return Record(
        *(status, frame, time, area, _signed(peak, WORD_BITS), *places, column_sum, row_sum, volume), place(centroid)
    )


def latency(rows: int, columns: int) -> int:
    """Clocks from the last depth of a frame to its record; two divisions of a bit a clock are most of them.

    Frames' last depths lie at least so many clocks apart.
    """
    division = place_bits(rows, columns) + FRACTION + 1  # and one more to begin each
    return CLOCKS_TO_TOUCHING + 1 + 2 * (division + 1)


def place_bits(rows: int, columns: int) -> int:
    return (max(rows, columns) - 1).bit_length()


def centroid(total: int, area: int, bits: int) -> int:
    """Mean of places of so many bits, by the steps of a division: to the nearest, ties to even."""
    remainder, quotient = total >> bits, 0
    for step in range(bits + FRACTION + 1):
        digit = total >> bits - 1 - step & 1 if step < bits else 0
        remainder = 2 * remainder + digit
        quotient = 2 * quotient + (remainder >= area)
        remainder -= area * (remainder >= area)
    return int(round_half_even(np.array(2 * quotient + (remainder != 0)), 2))


@dataclass
class ContactEvents:
    """Between two beats.

    Attributes
    ----------
    touching : bool
        As the last whole frame left it.
    frames : int
        Whole frames since the reset.
    settings, time
        Of the frame that is coming in; None: none has begun.
    """

    rows: int
    columns: int
    bottom_first: bool = False
    touching: bool = False
    frames: int = 0
    frames_before: int = 0  # in a row, that differ from `touching`
    settings: Settings | None = None
    time: int = 0
    row: int = 0
    column: int = 0
    above: list[tuple[int, int, int]] = field(default_factory=list)  # depth, row, column

    def beat(self, data: int, user: bool, last: bool, frame_end: bool, settings: Settings, time: int) -> Record | None:
        """One depth code leaves; with the last of a frame the frame's record.

        Raises
        ------
        ValueError
            No frame has begun.
        """
        if user:
            self.settings, self.time, self.above = settings, time, []
            self.row, self.column = (self.rows - 1 if self.bottom_first else 0), 0
        if self.settings is None:
            raise ValueError("a depth code left before the first of any frame")
        if data > (self.settings.off_threshold if self.touching else self.settings.on_threshold):
            self.above.append((data, self.row, self.column))
        self.column += 1
        if last:
            self.row, self.column = self.row + (-1 if self.bottom_first else 1), 0
        return self._record() if frame_end else None

    def _record(self) -> Record:
        assert self.settings is not None
        area = len(self.above)
        status = 0
        if (area >= self.settings.minimum_area) != self.touching:
            self.frames_before += 1
            if self.frames_before >= self.settings.debounce:
                self.touching, self.frames_before = not self.touching, 0
                status = BEGAN if self.touching else ENDED
        else:
            self.frames_before = 0
        self.frames = (self.frames + 1) % (1 << WORD_BITS)
        status |= TOUCHING * self.touching
        if not area:
            return Record(status, self.frames, self.time)
        depths, rows, columns = zip(*self.above, strict=True)
        peak = max(self.above, key=lambda one: one[0])  # the first of equals
        bits = place_bits(self.rows, self.columns)
        return Record(
            status,
            self.frames,
            self.time,
            area,
            peak[0],
            peak[1:],
            (min(rows), min(columns)),
            (max(rows), max(columns)),
            sum(columns),
            sum(rows),
            sum(depths),
            (centroid(sum(rows), area, bits), centroid(sum(columns), area, bits)),
        )

    def reset(self) -> None:
        """One edge in reset."""
        self.touching, self.frames, self.frames_before, self.settings = False, 0, 0, None


@dataclass
class Packets:
    """What is sent, between two clock edges.

    Attributes
    ----------
    sending : deque of int
        Words left of the packet that has begun; the first is offered.
    waiting : tuple of int or None
        The words of a record that waits for its turn.
    """

    sending: deque[int] = field(default_factory=deque)
    waiting: tuple[int, ...] | None = None

    def clock(self, renewed: tuple[int, ...] | None, ready: bool) -> bool:
        """One edge, at which a record may be renewed and a word may be taken; whether a record is lost there."""
        leaves = bool(self.sending) and ready
        send = self.waiting is not None and len(self.sending) <= leaves
        lost = renewed is not None and self.waiting is not None and not send
        if leaves:
            self.sending.popleft()
        if send and self.waiting is not None:
            self.sending.extend(self.waiting)
            self.waiting = None
        if renewed is not None:
            self.waiting = renewed
        return lost

    def reset(self) -> None:
        """One edge in reset."""
        self.sending.clear()
        self.waiting = None
