# SPDX-License-Identifier: Apache-2.0
"""Model of hdl/camera/dvp_receive.sv, edge by edge of its two clocks, and the pins of a camera for its input."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from tactile_depth.chip.common.td_async_fifo import AsyncFifo

FRONT = 1 << 9  # of a word of the queue: it stands in front of a frame's bytes
ROW_END = 1 << 8
LARGEST_COUNT = 255


class Pins(NamedTuple):
    """Pins of a camera in a clock of pclk."""

    vsync: bool
    href: bool
    data: int


class Beat(NamedTuple):
    """A byte on m_axis."""

    data: int
    last: bool
    user: bool


IDLE = Pins(False, False, 0)


def camera_pins(frame: np.ndarray, row_blank: int, frame_blank: int, sync: int = 2) -> Iterator[Pins]:
    """Yield the pins of a camera that sends a frame, clock by clock.

    Parameters
    ----------
    frame : uint8 array (rows, bytes of a row)
    row_blank, frame_blank : int
        Clocks behind each row, and in front of the first.
    sync : int
        Clocks with vsync high, in front of these.
    """
    yield from [Pins(True, False, 0)] * sync
    yield from [IDLE] * frame_blank
    for row in frame.tolist():
        yield from (Pins(False, True, byte) for byte in row)
        yield from [IDLE] * row_blank


@dataclass
class DvpReceive:
    """State between two edges.

    Attributes
    ----------
    fifo : AsyncFifo
        The queue; a word is a byte, with ROW_END behind a row, or FRONT and the number of frames given up.
    pins, vsync_before : Pins, bool
        Pins in their registers, and vsync a clock before.
    opening, receiving : bool
        True while the word in front of a frame waits for room; true once it, and every byte since, has found room.
    held : int or None
        The byte that waits to know whether it is the last of its row.
    given_up : int
        Frames given up since the last word in front of a frame.
    opened, first : bool
        True once a frame has begun since the reset; true until the first byte of a frame leaves.
    frames_lost : int
        The output.
    """

    fifo: AsyncFifo = field(default_factory=lambda: AsyncFifo(16))
    pins: Pins = IDLE
    vsync_before: bool = False
    opening: bool = False
    receiving: bool = False
    held: int | None = None
    given_up: int = 0
    opened: bool = False
    first: bool = False
    frames_lost: int = 0

    @property
    def beat(self) -> Beat | None:
        """Return the beat that is offered on m_axis, None if there is none."""
        word = self.fifo.read_data
        if word is None or word & FRONT or not self.opened:
            return None
        return Beat(word & LARGEST_COUNT, bool(word & ROW_END), self.first)

    def edges(self, pins: Pins | None, sink: tuple[bool, bool] | None) -> None:
        """Advance by an edge of pclk, of clk, or of both in the same instant.

        Parameters
        ----------
        pins : Pins or None
            Pins of the camera; None without an edge of pclk.
        sink : tuple of bool or None
            (rst, m_axis_tready); None without an edge of clk.
        """
        offered, word = self.beat, self.fifo.read_data
        written = self._camera_edge(pins) if pins is not None else None
        taken = sink is not None and (offered is None or sink[1])
        self.fifo.edges(written, taken, pins is not None, sink is not None)
        if sink is None:
            return
        reset, ready = sink
        self.frames_lost = 0
        if word is not None and word & FRONT:
            self.opened, self.first = True, True
            self.frames_lost = word & LARGEST_COUNT
        elif offered is not None and ready:
            self.first = False
        if reset:
            self.opened, self.frames_lost = False, 0

    def _camera_edge(self, pins: Pins) -> int | None:
        """Advance the camera's side; return the word that it offers to the queue."""
        starts = self.pins.vsync and not self.vsync_before
        in_row = self.pins.href and not starts
        word = None
        if self.opening:
            word = FRONT | self.given_up
        elif self.held is not None:
            word = self.held | (0 if in_row else ROW_END)
        room = self.fifo.write_ready
        lost = not room and (self.held is not None or (self.opening and in_row))
        if self.opening and room:
            self.receiving, self.given_up, self.opening = True, 0, False
        elif lost:
            self.receiving, self.opening = False, False
            self.given_up = min(self.given_up + 1, LARGEST_COUNT)
        self.held = self.pins.data if in_row and self.receiving else None
        if starts:
            self.opening, self.receiving = True, False
        self.vsync_before, self.pins = self.pins.vsync, pins
        return word
