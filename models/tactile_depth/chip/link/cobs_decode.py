# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/link/cobs_decode.sv."""

from __future__ import annotations

from typing import Final, NamedTuple

from tactile_depth.chip.link.framing import LONGEST_ON_LINE, RUN

LONGEST_PIECE: Final = LONGEST_ON_LINE - 2


class Decoded(NamedTuple):
    """Outputs of the decoder in a clock: a byte, or the end of a piece, or nothing.

    Attributes
    ----------
    byte : int or None
    ends, bad : bool
        A piece ends; it is bad.
    """

    byte: int | None = None
    ends: bool = False
    bad: bool = False


class CobsDecode:
    """State of the decoder between two clock edges.

    Parameters
    ----------
    longest : int
        Bytes of the longest piece.
    """

    def __init__(self, longest: int = LONGEST_PIECE) -> None:
        self._longest = longest
        self.reset()

    def reset(self) -> None:
        """Advance by one clock edge in reset."""
        self._piece: list[int | None] | None = None  # its bytes, None for a broken one; None before the first delimiter
        self._next_code = 0  # place of the next code in the piece, broken bytes not counted
        self._place = 0
        self._zero_due = False

    def clock(self, data: int | None, broken: bool = False) -> Decoded:
        """Advance by one clock edge and return the outputs behind it.

        `data` is the byte that came, None for none; `broken` is set for a byte that could not be received.
        """
        if data == 0:
            piece, inside = self._piece, self._place != self._next_code
            self.reset()
            self._piece = []
            return Decoded(ends=True, bad=inside or None in piece or len(piece) > self._longest) if piece else Decoded()
        if self._piece is None:
            return Decoded()
        if broken:
            self._piece.append(None)
        if data is None:
            return Decoded()
        self._piece.append(data)
        self._place += 1
        if self._place <= self._next_code:
            return Decoded(data)
        byte = 0 if self._zero_due else None
        self._next_code += data
        self._zero_due = data <= RUN
        return Decoded(byte)
