# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/link/depth_store.sv."""

from __future__ import annotations

from dataclasses import dataclass, field

from tactile_depth.chip.contact.contact_events import WORDS
from tactile_depth.chip.link.bank_choice import BankChoice


@dataclass
class DepthStore:
    """State of the core.

    Attributes
    ----------
    rows, columns, width, lanes : int
        Of frames, bits of a value, and values in a beat.
    banks : BankChoice
    in_frame, awaited : bool
        A frame comes; its record is awaited.
    beat, word : int
        The next one of a frame, and of a record.
    ended : int or None
        The bank of the frame whose record is awaited.
    values, words : dict
        What is stored, by bank and place.
    read : list
        The values that were read last, by clocks; None where it is unknown.
    """

    rows: int
    columns: int
    width: int
    lanes: int
    banks: BankChoice = field(default_factory=BankChoice)
    in_frame: bool = False
    awaited: bool = False
    beat: int = 0
    word: int = 0
    ended: int | None = None
    values: dict[tuple[int | None, int], int] = field(default_factory=dict)
    words: dict[tuple[int | None, int], int] = field(default_factory=dict)
    read: list[int | None] = field(default_factory=lambda: [None] * 3)
    _record: int | None = None

    @property
    def last_beat(self) -> bool:
        """Return whether the next beat of the present frame is its last."""
        return self.in_frame and self.beat == self.rows * self.columns // self.lanes - 1

    def clock(self, **pins: int) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        begins = pins["s_axis_tvalid"] and pins["s_axis_tuser"]
        ends = pins["s_axis_tvalid"] and not begins and self.last_beat
        publish = self.awaited and pins["s_event_tvalid"] and pins["s_event_tlast"]
        out: dict[str, int | None] = {"value_data": self.read[2], "record_data": self._record}
        source = self.banks.read
        read = self.values.get((source, pins["value_address"])) if pins["value_read"] else self.read[0]
        self.read = [read, *self.read[:2]]
        self._record = self.words.get((source, pins["record_word"]))
        banks = self.banks.clock(
            rst=pins["rst"],
            keep=pins["keep"],
            write_begin=begins,
            write_end=ends,
            publish=publish,
            take=pins["frame_take"],
            done=pins["frame_done"],
        )
        if pins["s_axis_tvalid"] and (begins or self.in_frame):
            first, lane_bits = 0 if begins else self.beat, -(-self.width // 8) * 8
            for lane in range(self.lanes):
                value = pins["s_axis_tdata"] >> lane * lane_bits & (1 << self.width) - 1
                self.values[banks["write_bank"], first * self.lanes + lane] = value
            self.beat, self.in_frame = first + 1, not ends
        if pins["s_event_tvalid"]:
            if self.awaited:
                self.words[self.ended, self.word] = pins["s_event_tdata"]
            self.word = 0 if pins["s_event_tlast"] else (self.word + 1) % WORDS
        self.awaited = bool(ends or (self.awaited and not publish))
        self.ended = banks["write_bank"] if ends else self.ended
        if pins["rst"]:
            self.in_frame, self.awaited, self.word = False, False, 0
        return out | {"frame_valid": banks["waiting"], "skipped": banks["replaced"]}
