# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/depth_gate.sv: two queues, one of words to send, one of words to look at."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from typing import NamedTuple

from models.axis_skid import CAPACITY


class Word(NamedTuple):
    """A depth with its marks: first of a frame, last of a row, last of a frame."""

    data: int
    user: bool
    last: bool
    frame_end: bool


@dataclass
class DepthGate:
    """Between two clock edges.

    Attributes
    ----------
    sending : deque of Word
        Words that the sink has not taken, oldest first; the first is offered.
    looking : deque of (Word, bool)
        Words not looked at, and whether they belong to a frame that waits for nobody.
    looked : int
        How many of `sending`, from the oldest on, have been looked at.
    dropping : bool
        drop_frames, as it holds for the frame that is coming in.
    given_up : bool
        So is that frame.
    starting : bool
        In reset, and in the clock after it: nothing is taken yet.
    """

    sending: deque[Word] = field(default_factory=deque)
    looking: deque[tuple[Word, bool]] = field(default_factory=deque)
    looked: int = 0
    dropping: bool = False
    given_up: bool = False
    starting: bool = True

    @property
    def room(self) -> bool:
        return not self.starting and len(self.sending) < CAPACITY

    @property
    def en(self) -> bool:
        return not self.starting and len(self.looking if self.dropping else self.sending) < CAPACITY

    def look(self, ready: bool) -> Word | None:
        """The word that is looked at in this clock."""
        if not self.looking:
            return None
        word, dropping = self.looking[0]
        leaves = ready and bool(self.sending) and not self.looked
        return word if self.dropping or dropping or leaves else None

    def dropped(self, word: Word | None) -> bool:
        """Whether a frame is given up in this clock, at this word."""
        return word is not None and self.en and not self.room and (word.user or not self.given_up)

    def clock(self, word: Word | None, ready: bool, drop_frames: bool) -> None:
        """One edge: `word` is present on the input (None: no word), the sink is `ready`."""
        moves, room, looked_at = word is not None and self.en, self.room, self.look(ready)
        if looked_at is not None:
            self.looking.popleft()
            self.looked += any(looked_at is other for other in self.sending)
        if ready and self.sending:
            self.sending.popleft()
            self.looked -= 1
        if word is not None and moves:
            self.given_up = not room or (self.given_up and not word.user)
            if not self.given_up:
                self.sending.append(word)
            self.looking.append((word, self.dropping))
        if word is None or (moves and word.frame_end):
            self.dropping = drop_frames
        self.starting = False

    def reset(self) -> None:
        """One edge in reset."""
        self.sending.clear()
        self.looking.clear()
        self.looked, self.dropping, self.starting = 0, False, True
