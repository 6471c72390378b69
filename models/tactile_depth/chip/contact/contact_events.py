# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/contact/contact_events.sv: the record of each frame, from its depth codes."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.contact import centroid
from tactile_depth.chip.contact.beats import marked
from tactile_depth.chip.contact.contact_debounce import ContactDebounce
from tactile_depth.chip.contact.contact_peak import ContactPeak, Peak, cycles_to_peak
from tactile_depth.chip.contact.contact_sums import ContactSums, Sums, cycles_to_sums
from tactile_depth.chip.contact.frame_flags import FLAG_WORDS, NO_FLAGS, FrameFlags
from tactile_depth.chip.contact.record_packets import RecordPackets
from tactile_depth.chip.fixed_point import codes, joined, split
from tactile_depth.chip.resources import DEPTH_MARKS, Parts, Words, delay_line

WORD_BITS = 32
CYCLES_TO_TOUCHING = 3  # from the last depth of a frame to `touching`


class Settings(NamedTuple):
    """Values of the registers at the first depth of a frame."""

    on_threshold: int
    off_threshold: int
    area_threshold: int
    minimum_area: int
    debounce: int


UNSIGNED = "minimum_area", "debounce"


class Record(NamedTuple):
    """The contact record of a frame. Positions are (row, column), with rows counted from the top of the picture.

    The peak is that of the depths above the threshold in force; from `area` on, what is above `area_threshold` counts.
    The weight of a depth is what it is above that.
    """

    status: int
    frame: int
    time: int
    peak: int = 0
    peak_position: tuple[int, int] = (0, 0)
    area_threshold: int = 0
    area: int = 0
    least: tuple[int, int] = (0, 0)
    greatest: tuple[int, int] = (0, 0)
    weight: int = 0
    centroid: tuple[int, int] = (0, 0)  # in units of 2**-FRACTION pixels
    flags: FrameFlags = NO_FLAGS

    @property
    def volume(self) -> int:
        """Sum of the depth codes of the area."""
        return self.weight + self.area * self.area_threshold

    @property
    def box_share(self) -> float:
        """Share of the bounding box that the area fills; 0 without area."""
        rows, columns = (most - least + 1 for least, most in zip(self.least, self.greatest, strict=True))
        return self.area / (rows * columns)

    @property
    def words(self) -> tuple[int, ...]:
        """Words of the record, in the order in which they leave."""
        positions = self.peak_position, self.least, self.greatest, self.centroid
        peak_at, least, greatest, middle = (row << 16 | column for row, column in positions)
        peak, level = (code % (1 << WORD_BITS) for code in (self.peak, self.area_threshold))
        high, low = divmod(self.weight, 1 << WORD_BITS)
        contact = peak, peak_at, level, self.area, least, greatest, low, high, middle
        return (*self[:3], *contact, *self.flags.words)


def _signed(word: int) -> int:
    return word - (word >> WORD_BITS - 1 << WORD_BITS)


WORDS = len(Record(0, 0, 0).words)


def record(words: Sequence[int]) -> Record:
    """Decode the words of a packet or of the registers."""

    def position(word: int) -> tuple[int, int]:
        return word >> 16, word & 0xFFFF

    status, frame, time, peak, peak_at, level, area, least, greatest, low, high, middle, *flags = words
    return Record(
        *(status, frame, time, _signed(peak), position(peak_at), _signed(level), area, position(least)),
        *(position(greatest), high << WORD_BITS | low, position(middle), FrameFlags.of(flags)),
    )


def area_threshold(setting: int, in_force: int, last_peak: int | None, width: int) -> int:
    """Return the depth code above which a pixel is in the area of a frame.

    Parameters
    ----------
    setting : int
        Value of AREA_THRESHOLD.
    in_force : int
        Threshold above which a depth of this frame is touched.
    last_peak : int or None
        Peak of the last frame; None if it had no depth above.
    width : int
        Bits of a depth code.
    """
    level = max(in_force, setting if last_peak is None else min(setting, last_peak >> 1))
    return min(max(level, -1 << width - 1), (1 << width - 1) - 1)


def latency(rows: int, columns: int, lanes: int = 1) -> int:
    """Return the cycles from the last depths of a frame to its record; the divisions of the centroid dominate.

    The last depths of two frames are at least this number of cycles apart.
    """
    delay = cycles_to_peak(lanes) + 3  # until the area threshold of the next frame is there
    return delay + cycles_to_sums(lanes) + 1 + centroid.cycles(centroid.position_bits(rows, columns)) + 1


class ContactEvents:
    """State between two beats.

    Parameters
    ----------
    rows, columns : int
    width : int
        Bits of a depth code.
    bottom_first : bool
        The bottom row of the picture comes first.

    Attributes
    ----------
    frames : int
        Complete frames since the reset.
    last_peak : int or None
        Peak of the last complete frame; None if it had no depth above.
    settings, time
        Registers and time of the current frame; `settings` is None before the first frame.
    """

    def __init__(self, rows: int, columns: int, width: int, bottom_first: bool = False) -> None:
        self.peak = ContactPeak(rows, columns, bottom_first)
        self.sums = ContactSums(rows, columns, bottom_first)
        self.debounce = ContactDebounce()
        self.width = width
        self.frames = 0
        self.last_peak: int | None = None
        self.settings: Settings | None = None
        self.time = 0

    @property
    def touching(self) -> bool:
        """Result of the last complete frame."""
        return self.debounce.touching

    def _in_force(self, settings: Settings) -> int:
        return settings.off_threshold if self.touching else settings.on_threshold

    def _level(self, settings: Settings) -> int:
        return area_threshold(settings.area_threshold, self._in_force(settings), self.last_peak, self.width)

    def beat(
        self,
        data: int,
        frame_start: bool,
        row_end: bool,
        frame_end: bool,
        settings: Settings,
        time: int,
        flags: FrameFlags = NO_FLAGS,
    ) -> Record | None:
        """Take a depth code that leaves; return the record of the frame with its last code, else None.

        Settings and time count with the first code of a frame, flags with the last.

        Raises
        ------
        ValueError
            No frame has begun.
        """
        if frame_start:
            self.settings, self.time = settings, time
        if self.settings is None:
            raise ValueError("a depth code left before the first of any frame")
        peak = self.peak.beat(data, frame_start, row_end, frame_end, self._in_force(self.settings))
        sums = self.sums.beat(data, frame_start, frame_end, self._level(self.settings))
        return None if peak is None or sums is None else self._record(peak, sums, flags)

    def whole_frame(self, depths: np.ndarray, settings: Settings, time: int, flags: FrameFlags = NO_FLAGS) -> Record:
        """Return the record of a frame whose depth codes leave one after another, as `beat` makes it.

        Parameters
        ----------
        depths : int array (rows, columns)
            In the order in which rows leave.
        """
        self.settings, self.time = settings, time
        peak = self.peak.whole_frame(depths, self._in_force(settings))
        return self._record(peak, self.sums.whole_frame(depths, self._level(settings)), flags)

    def _record(self, peak: Peak, sums: Sums, flags: FrameFlags) -> Record:
        assert self.settings is not None
        level = self._level(self.settings)
        status = self.debounce.frame(peak.above, self.settings.minimum_area, self.settings.debounce)
        self.frames = (self.frames + 1) % (1 << WORD_BITS)
        self.last_peak = peak.peak if peak.above else None
        limits, middle = (sums.least, sums.greatest), self._centroid(sums)
        if not sums.area:
            row, column = peak.position
            limits, middle = (peak.position, peak.position), (row << centroid.FRACTION, column << centroid.FRACTION)
        found = peak.peak, peak.position, level, sums.area, *limits, sums.weight, middle
        return Record(status, self.frames, self.time, *found, flags)

    def _centroid(self, sums: Sums) -> tuple[int, int]:
        """Return row and column; the moments count from the last row to come and from the last column."""
        if not sums.area:
            return 0, 0
        rows, columns = self.sums.rows, self.sums.columns
        bits = centroid.position_bits(rows, columns)
        row, column = (centroid.mean(moment, sums.weight, bits) for moment in (sums.row_moment, sums.column_moment))
        last_row, last_column = (length - 1 << centroid.FRACTION for length in (rows, columns))
        return row if self.sums.bottom_first else last_row - row, last_column - column

    def reset(self) -> None:
        """Advance by one clock edge in reset."""
        self.debounce = ContactDebounce()
        self.frames, self.last_peak, self.settings = 0, None, None
        self.peak.found, self.sums.threshold = None, None


class EventsByClock:
    """ContactEvents of beats, and what they change, on its way."""

    def __init__(self, width: int, rows: int, columns: int, lanes: int, bottom_first: int) -> None:
        self.width, self.lanes, self.latency = width, lanes, latency(rows, columns, lanes)
        self.events, self.packets = ContactEvents(rows, columns, width, bool(bottom_first)), RecordPackets(WORDS)
        self._clear()

    def _clear(self) -> None:
        self._touching = deque([False] * CYCLES_TO_TOUCHING)
        self.due: deque[Record | None] = deque([None] * (self.latency - 1))

    def clock(
        self,
        *,
        rst: int,
        in_valid: int,
        in_position: int,
        in_data: int,
        in_above: int,
        in_time: int,
        in_flags: int,
        in_flipped: int,
        in_residual: int,
        m_event_tready: int,
        **settings: int,
    ) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        due, record = self.due.popleft(), None
        if due:
            due = due._replace(flags=due.flags._replace(flipped=bool(in_flipped), residual=bool(in_residual)))
        new = {"new_valid": due is not None, "new_record": joined(due.words if due else (), WORD_BITS)}
        out: dict[str, int | None] = {"touching": self._touching.popleft(), "flipped": 0}
        out |= self.packets.clock(rst=rst, **new, m_event_tready=m_event_tready)
        if in_valid:
            flags = FrameFlags.of(split(in_flags, FLAG_WORDS, WORD_BITS))
            words = {
                name: word if name in UNSIGNED else codes(word, 1, self.width + 1)[0] for name, word in settings.items()
            }
            for beat in marked(in_data, in_position, self.lanes, self.width):
                record = self.events.beat(*beat, Settings(**words), in_time, flags)
        self._touching.append(self.events.touching)
        self.due.append(record)
        if rst:
            self.events.reset()
            self._clear()
        return out


def parts(config: Configuration) -> Parts:
    bits = config.lanes * config.depth.width
    return [Words(bits), *delay_line(bits + DEPTH_MARKS, config.lanes.bit_length() + 5)]
