# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/contact/contact_events.sv: the record of each frame, from its depth codes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from tactile_depth.contact import centroid
from tactile_depth.contact.contact_debounce import ContactDebounce
from tactile_depth.contact.contact_sums import WORD_BITS, ContactSums, Sums, Thresholds, cycles_to_sums

CYCLES_TO_TOUCHING = 3  # from the last depth of a frame to `touching`


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
    peak_position: tuple[int, int] = (0, 0)
    least: tuple[int, int] = (0, 0)
    greatest: tuple[int, int] = (0, 0)
    column_sum: int = 0
    row_sum: int = 0
    volume: int = 0
    centroid: tuple[int, int] = (0, 0)  # in units of 2**-FRACTION pixels

    @property
    def words(self) -> tuple[int, ...]:
        """Words of the record, in the order in which they leave."""
        row, column = self.centroid
        return (self.status, self.frame, self.time, self.area, *Sums(*self[3:-1]).words, row << 16 | column)


def _signed(word: int, bits: int) -> int:
    return word - (word >> bits - 1 << bits)


WORDS = len(Record(0, 0, 0).words)


def record(words: Sequence[int]) -> Record:
    """Decode the words of a packet or of the registers."""

    def position(word: int) -> tuple[int, int]:
        return word >> 16, word & 0xFFFF

    status, frame, time, area, peak, peak_at, least, greatest, column_sum, row_sum, low, high, middle = words
    volume = _signed(high << WORD_BITS | low, 2 * WORD_BITS)
    positions = position(peak_at), position(least), position(greatest)
    return Record(
        *(status, frame, time, area, _signed(peak, WORD_BITS), *positions, column_sum, row_sum, volume),
        position(middle),
    )


def latency(rows: int, columns: int, lanes: int = 1) -> int:
    """Return the cycles from the last depths of a frame to its record; the divisions of the centroid dominate.

    The last depths of two frames are at least this number of cycles apart.
    """
    return cycles_to_sums(lanes) + centroid.cycles(centroid.position_bits(rows, columns)) + 1


class ContactEvents:
    """State between two beats.

    Attributes
    ----------
    frames : int
        Complete frames since the reset.
    settings, time
        Registers and time of the current frame; `settings` is None before the first frame.
    """

    def __init__(self, rows: int, columns: int, bottom_first: bool = False) -> None:
        self.sums = ContactSums(rows, columns, bottom_first)
        self.debounce = ContactDebounce()
        self.frames = 0
        self.settings: Settings | None = None
        self.time = 0

    @property
    def touching(self) -> bool:
        """Result of the last complete frame."""
        return self.debounce.touching

    def beat(
        self, data: int, frame_start: bool, row_end: bool, frame_end: bool, settings: Settings, time: int
    ) -> Record | None:
        """Take a depth code that leaves; return the record of the frame with its last code, else None.

        Raises
        ------
        ValueError
            No frame has begun.
        """
        if frame_start:
            self.settings, self.time = settings, time
        thresholds = Thresholds(*settings[:2]) if frame_start else Thresholds(0, 0)
        sums = self.sums.beat(data, frame_start, row_end, frame_end, thresholds, self.touching)
        return None if sums is None else self._record(sums)

    def whole_frame(self, depths: np.ndarray, settings: Settings, time: int) -> Record:
        """Return the record of a frame whose depth codes leave one after another, as `beat` makes it.

        Parameters
        ----------
        depths : int array (rows, columns)
            In the order in which rows leave.
        """
        self.settings, self.time = settings, time
        return self._record(self.sums.whole_frame(depths, Thresholds(*settings[:2]), self.touching))

    def _record(self, sums: Sums) -> Record:
        assert self.settings is not None
        status = self.debounce.frame(sums.area, self.settings.minimum_area, self.settings.debounce)
        self.frames = (self.frames + 1) % (1 << WORD_BITS)
        middle = (0, 0)
        if sums.area:
            bits = centroid.position_bits(self.sums.rows, self.sums.columns)
            middle = (centroid.mean(sums.row_sum, sums.area, bits), centroid.mean(sums.column_sum, sums.area, bits))
        return Record(status, self.frames, self.time, *sums, middle)

    def reset(self) -> None:
        """Advance by one clock edge in reset."""
        self.debounce.reset()
        self.frames, self.settings, self.sums.thresholds = 0, None, None
