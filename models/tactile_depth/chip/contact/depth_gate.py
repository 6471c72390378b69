# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/contact/depth_gate.sv: a queue of words to send and a queue of words to tap."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from typing import NamedTuple

from tactile_depth.chip.common.td_axis_skid import CAPACITY


class Word(NamedTuple):
    """A depth code with its marks: first of a frame, last of a row, last of a frame."""

    data: int
    frame_start: bool
    row_end: bool
    frame_end: bool


@dataclass
class DepthGate:
    """State between two clock edges.

    Attributes
    ----------
    sending : deque of Word
        Words that the sink has not taken, oldest first; the first is offered.
    tapping : deque of (Word, bool)
        Words that are not tapped yet; True for a word of a frame that does not wait for the sink.
    tapped : int
        Number of words in `sending`, from the oldest on, that have been tapped.
    dropping : bool
        Value of drop_frames for the current input frame.
    given_up : bool
        True if the current input frame is given up.
    starting : bool
        True in reset and in the cycle after it, when nothing is taken.
    """

    sending: deque[Word] = field(default_factory=deque)
    tapping: deque[tuple[Word, bool]] = field(default_factory=deque)
    tapped: int = 0
    dropping: bool = False
    given_up: bool = False
    starting: bool = True

    @property
    def room(self) -> bool:
        return not self.starting and len(self.sending) < CAPACITY

    @property
    def en(self) -> bool:
        return not self.starting and len(self.tapping if self.dropping else self.sending) < CAPACITY

    def tap(self, ready: bool) -> Word | None:
        """Return the word that is tapped in this cycle, None without one."""
        if not self.tapping:
            return None
        word, dropping = self.tapping[0]
        leaves = ready and bool(self.sending) and not self.tapped
        return word if self.dropping or dropping or leaves else None

    def dropped(self, word: Word | None) -> bool:
        """Return True if the frame is given up in this cycle, at this word."""
        return word is not None and self.en and not self.room and (word.frame_start or not self.given_up)

    def clock(self, word: Word | None, ready: bool, drop_frames: bool) -> None:
        """Advance by one clock edge; `word` is on the input (None: no word), `ready` is set by the sink."""
        moves, room, tapped_now = word is not None and self.en, self.room, self.tap(ready)
        if tapped_now is not None:
            self.tapping.popleft()
            self.tapped += any(tapped_now is other for other in self.sending)
        if ready and self.sending:
            self.sending.popleft()
            self.tapped -= 1
        if word is not None and moves:
            self.given_up = not room or (self.given_up and not word.frame_start)
            if not self.given_up:
                self.sending.append(word)
            self.tapping.append((word, self.dropping))
        if word is None or (moves and word.frame_end):
            self.dropping = drop_frames
        self.starting = False

    def reset(self) -> None:
        """Advance by one clock edge in reset."""
        self.sending.clear()
        self.tapping.clear()
        self.tapped, self.dropping, self.starting = 0, False, True
