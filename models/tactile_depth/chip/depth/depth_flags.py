# SPDX-License-Identifier: Apache-2.0
"""Model of hdl/depth/depth_flags.sv: the flags of the frame of depth that leaves, with the clips of its depth."""

from __future__ import annotations

from tactile_depth.chip.contact.frame_flags import FLAG_WORDS, FrameFlags
from tactile_depth.chip.fixed_point import joined, split


class DepthFlags:
    """Clips of the frame that enters and of the one that leaves, and the flags of that; None before one has left."""

    def __init__(self) -> None:
        self._flags: FrameFlags | None = None
        self._clear()

    def _clear(self) -> None:
        self._entering = self._leaving = self._zero = self._begun = False

    def clock(
        self, *, rst: int, en: int, frame_start: int, solver_clipped: int, in_flags: int, marked: int, **pins: int
    ) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        self._entering |= bool(solver_clipped)
        self._leaving |= bool(solver_clipped)
        self._zero |= bool(pins["zero_clipped"])
        out: dict[str, int | None] = {"entering_clipped": self._entering, "out_flags": None}
        if self._flags is not None:
            flags = self._flags._replace(depth_clipped=self._leaving, zero_clipped=self._zero)
            out["out_flags"] = joined(flags.words, 32)
        if en:
            if frame_start:
                self._entering = False
            if self._begun:
                self._flags = FrameFlags.of(split(in_flags, FLAG_WORDS, 32))
                self._leaving = bool(marked or solver_clipped)
            self._begun = bool(pins["depth_starts"])
            if pins["depth_ends"]:
                self._zero = False
        if rst:
            self._clear()
        return out
