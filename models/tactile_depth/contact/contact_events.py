# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/contact/contact_events.sv: records beat by beat, packets cycle by cycle."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from tactile_depth.common.round_saturate import round_half_even

FRACTION = 4  # fraction bits of a centroid, in pixels
WORD_BITS = 32
TOUCHING, BEGAN, ENDED = 1, 2, 4  # bits of word 0
CLOCKS_TO_TOUCHING = 3  # cycles from the last depth of a frame to `touching`


class Settings(NamedTuple):
    """Values of the registers at the first depth of a frame."""

    on_threshold: int
    off_threshold: int
    minimum_area: int
    debounce: int


class Record(NamedTuple):
    """The contact record of a frame. Positions are (row, column), with rows counted from the top of the picture."""

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
    centroid: tuple[int, int] = (0, 0)  # in units of 2**-FRACTION pixels

    @property
    def words(self) -> tuple[int, ...]:
        """Words of the record, in the order in which they leave."""
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
    """Decode the words of a packet or of the registers."""

    def place(word: int) -> tuple[int, int]:
        return word >> 16, word & 0xFFFF

    status, frame, time, area, peak, peak_place, least, greatest, column_sum, row_sum, low, high, centroid = words
    volume = _signed(high << WORD_BITS | low, 2 * WORD_BITS)
    places = place(peak_place), place(least), place(greatest)
    return Record(
        *(status, frame, time, area, _signed(peak, WORD_BITS), *places, column_sum, row_sum, volume), place(centroid)
    )


def latency(rows: int, columns: int) -> int:
    """Return the cycles from the last depth of a frame to its record; two divisions, one bit per cycle, dominate.

    The last depths of two frames are at least this number of cycles apart.
    """
    division = place_bits(rows, columns) + FRACTION + 1  # and one more cycle to begin each division
    return CLOCKS_TO_TOUCHING + 1 + 2 * (division + 1)


def place_bits(rows: int, columns: int) -> int:
    return (max(rows, columns) - 1).bit_length()


def centroid(total: int, area: int, bits: int) -> int:
    """Return the mean of positions of `bits` bits, computed bit by bit, rounded to the nearest with ties to even."""
    remainder, quotient = total >> bits, 0
    for step in range(bits + FRACTION + 1):
        digit = total >> bits - 1 - step & 1 if step < bits else 0
        remainder = 2 * remainder + digit
        quotient = 2 * quotient + (remainder >= area)
        remainder -= area * (remainder >= area)
    return int(round_half_even(np.array(2 * quotient + (remainder != 0)), 2))


@dataclass
class ContactEvents:
    """State between two beats.

    Attributes
    ----------
    touching : bool
        Result of the last complete frame.
    frames : int
        Complete frames since the reset.
    settings, time
        Registers and time of the current frame; `settings` is None before the first frame.
    """

    rows: int
    columns: int
    bottom_first: bool = False
    touching: bool = False
    frames: int = 0
    frames_before: int = 0  # consecutive frames that differ from `touching`
    settings: Settings | None = None
    time: int = 0
    row: int = 0
    column: int = 0
    above: list[tuple[int, int, int]] = field(default_factory=list)  # depth, row, column

    def beat(self, data: int, user: bool, last: bool, frame_end: bool, settings: Settings, time: int) -> Record | None:
        """Take a depth code that leaves; return the record of the frame with its last code, else None.

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
        if not frame_end:
            return None
        depths, rows, columns = np.array(self.above, np.int64).reshape(-1, 3).T
        return self._record(depths, rows, columns)

    def whole_frame(self, depths: np.ndarray, settings: Settings, time: int) -> Record:
        """Return the record of a frame whose depth codes leave one after another, as `beat` makes it.

        Parameters
        ----------
        depths : int array (rows, columns)
            In the order in which rows leave.
        """
        self.settings, self.time = settings, time
        above = depths > (settings.off_threshold if self.touching else settings.on_threshold)
        rows, columns = np.nonzero(above)
        upright = self.rows - 1 - rows if self.bottom_first else rows
        return self._record(depths[above].astype(np.int64), upright, columns)

    def _record(self, depths: np.ndarray, rows: np.ndarray, columns: np.ndarray) -> Record:
        """Return the record, from the depths above the threshold and their positions in the order of the stream."""
        assert self.settings is not None
        area = len(depths)
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
        first = int(depths.argmax())  # the first of equal peaks
        bits = place_bits(self.rows, self.columns)
        row_sum, column_sum = int(rows.sum()), int(columns.sum())
        return Record(
            status,
            self.frames,
            self.time,
            area,
            int(depths[first]),
            (int(rows[first]), int(columns[first])),
            (int(rows.min()), int(columns.min())),
            (int(rows.max()), int(columns.max())),
            column_sum,
            row_sum,
            int(depths.sum()),
            (centroid(row_sum, area, bits), centroid(column_sum, area, bits)),
        )

    def reset(self) -> None:
        """Advance by one clock edge in reset."""
        self.touching, self.frames, self.frames_before, self.settings = False, 0, 0, None


@dataclass
class Packets:
    """State of the packet sender between two clock edges.

    Attributes
    ----------
    sending : deque of int
        Remaining words of the current packet; the first one is offered.
    waiting : tuple of int or None
        Words of a record that waits for the current packet to end.
    """

    sending: deque[int] = field(default_factory=deque)
    waiting: tuple[int, ...] | None = None

    def clock(self, renewed: tuple[int, ...] | None, ready: bool) -> bool:
        """Advance by one clock edge; return True if a record is lost.

        `renewed` holds the words of a new record (None: no new record); `ready` is set if the sink takes a word.
        """
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
        """Advance by one clock edge in reset."""
        self.sending.clear()
        self.waiting = None
