# SPDX-License-Identifier: Apache-2.0
"""Flags that the device gives with each frame, `frame_flags_t` of hdl/td_types_pkg.sv: words 12 to 14 of its record."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from tactile_depth.chip.fixed_point import joined, split

MARKS = 7  # flags of one bit, from bit 0 on
HALF_BITS = 16
FLAG_WORDS = 3


class FrameFlags(NamedTuple):
    """Flags of a frame: how far its depth holds.

    Attributes
    ----------
    colours_clipped : bool
        A value of its slopes was clipped: by the flat field, a light gain or the polynomials.
    depth_clipped : bool
        The solver clipped, in this frame or in one that was in it beside this frame.
    zero_clipped : bool
        The zero offset clipped a depth.
    light_moves : bool
        A light gain moves by 1/32 or more after this frame: it does not fit the light yet.
    resumed : bool
        Pixels were dropped before this frame began.
    flipped : bool
        A flipped bit was seen while the frame was in flight.
    residual : bool
        The depth of the frame does not fit its slopes.
    light_gains : tuple of int
        Gains of red, green and blue in force, in units of 2**-15; 0 without light gains.
    dark, steep : int
        Dark pixels, and pixels steeper than the slopes of the calibration; 65,535 stands for more.
    others : int
        Bits 7 to 15 of the first word, which a later device may use.
    """

    colours_clipped: bool = False
    depth_clipped: bool = False
    zero_clipped: bool = False
    light_moves: bool = False
    resumed: bool = False
    flipped: bool = False
    residual: bool = False
    light_gains: tuple[int, int, int] = (0, 0, 0)
    dark: int = 0
    steep: int = 0
    others: int = 0

    @property
    def words(self) -> tuple[int, ...]:
        """Words of the record."""
        bits = [int(getattr(self, name)) for name in self._fields[:MARKS]]
        marks = joined(bits, 1) | self.others << MARKS
        red, green, blue = self.light_gains
        return tuple(joined(halves, HALF_BITS) for halves in ((marks, red), (green, blue), (self.dark, self.steep)))

    @classmethod
    def of(cls, words: Sequence[int]) -> FrameFlags:
        """Return the flags of words of a record."""
        halves = [half for word in words for half in split(word, 2, HALF_BITS)]
        marks, red, green, blue, dark, steep = halves
        set_marks = map(bool, split(marks, MARKS, 1))
        return cls._make((*set_marks, (red, green, blue), dark, steep, marks >> MARKS))


NO_FLAGS = FrameFlags()
