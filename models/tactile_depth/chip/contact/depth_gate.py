# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/contact/depth_gate.sv: a queue of words to send and a queue of words to tap."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

from tactile_depth.chip.common.td_axis_skid import CAPACITY

Word = tuple[int, int]  # marks and depth code
FRAME_START, FRAME_END = 4, 1  # marks


@dataclass
class DepthGate:
    """State between two clock edges.

    Attributes
    ----------
    sending : deque of Word
        Words that the sink has not taken, oldest first; the first is offered.
    tapping : deque of (Word, bool, bool)
        Words that are not tapped yet; whether a word's frame does not wait for the sink, and whether it was kept.
    tapped : int
        Number of words in `sending`, from the oldest on, that have been tapped.
    dropping : bool
        Value of drop_frames for the current input frame.
    given_up : bool
        True if the current input frame, or between frames the last one, is given up.
    inside : bool
        True between the first and the last word of a frame.
    starting : bool
        True in reset and in the cycle after it, when nothing is taken.
    """

    sending: deque[Word] = field(default_factory=deque)
    tapping: deque[tuple[Word, bool, bool]] = field(default_factory=deque)
    tapped: int = 0
    dropping: bool = False
    given_up: bool = False
    inside: bool = False
    starting: bool = True

    def clock(
        self, *, rst: int, drop_frames: int, in_valid: int, in_position: int, in_data: int, m_ready: int
    ) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        en = not self.starting and len(self.tapping if self.dropping else self.sending) < CAPACITY
        room = not self.starting and len(self.sending) < CAPACITY
        leaves, moves, word = m_ready and bool(self.sending), in_valid and en, (in_position, in_data)
        out: dict[str, int | None] = {"en": en, "event_dropped": 0, "m_valid": bool(self.sending), "tap_valid": 0}
        out["stalled"] = self.given_up or not (self.dropping or en)
        if self.sending:
            out["m_position"], out["m_data"] = self.sending[0]
        if self.tapping:
            (position, data), dropping, kept = self.tapping[0]
            if self.dropping or dropping or (leaves and not self.tapped):
                out |= {"tap_valid": 1, "tap_position": position, "tap_data": data}
                self.tapping.popleft()
                self.tapped += kept
        if leaves:
            self.sending.popleft()
            self.tapped -= 1
        if moves:
            given_up = self.given_up and not in_position & FRAME_START
            out["event_dropped"] = not given_up and not room
            self.given_up = given_up or not room
            if not self.given_up:
                self.sending.append(word)
            self.tapping.append((word, self.dropping, not self.given_up))
            self.inside = not in_position & FRAME_END
        if not in_valid or (moves and in_position & FRAME_END):
            self.dropping = bool(drop_frames)
        self.starting = bool(rst)
        if rst:
            self.sending.clear()
            self.tapping.clear()
            self.tapped, self.dropping, self.given_up, self.inside = 0, False, False, False
        out["en_next"] = None if rst else len(self.tapping if self.dropping else self.sending) < CAPACITY
        return out
