# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/link/cobs_decode.sv."""

from __future__ import annotations

from typing import Final

from tactile_depth.chip.link.framing import LONGEST_ON_LINE, RUN

LONGEST_PIECE: Final = LONGEST_ON_LINE - 2


class CobsDecode:
    """State of the decoder between two clock edges.

    Parameters
    ----------
    longest : int
        Bytes of the longest piece.

    Attributes
    ----------
    piece : list of int or None
        Bytes that came of it, None for a broken one; None before the first delimiter.
    """

    def __init__(self, longest: int = LONGEST_PIECE) -> None:
        self._longest = longest
        self.reset()

    def reset(self) -> None:
        """Advance by one clock edge in reset."""
        self.piece: list[int | None] | None = None
        self._next_code = 0  # place of the next code in the piece, broken bytes not counted
        self._place = 0
        self._zero_due = False
        self._out = {"out_valid": 0, "out_end": 0}

    def clock(self, *, rst: int = 0, in_valid: int = 0, in_data: int = 0, in_broken: int = 0) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it, but those that do not count."""
        out, self._out = self._out, {"out_valid": 0, "out_end": 0}
        if rst:
            self.reset()
        elif in_valid and not in_data:
            piece, inside = self.piece, self._place != self._next_code
            self.reset()
            self.piece = []
            if piece:
                self._out |= {"out_end": 1, "out_bad": inside or None in piece or len(piece) > self._longest}
        elif self.piece is not None and (in_valid or in_broken):
            self.piece.append(None if in_broken else in_data)
            self._place += in_valid
            if in_valid and self._place <= self._next_code:
                self._out |= {"out_valid": 1, "out_data": in_data}
            elif in_valid:
                self._out |= {"out_valid": 1, "out_data": 0} if self._zero_due else {}
                self._next_code += in_data
                self._zero_due = in_data <= RUN
        return out
