# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/contact/contact_debounce.sv, frame by frame."""

from __future__ import annotations

from dataclasses import dataclass

TOUCHING, BEGAN, ENDED = 1, 2, 4  # bits of the status


@dataclass
class ContactDebounce:
    """State between two frames.

    Attributes
    ----------
    touching : bool
        Result of the last frame.
    differing_frames : int
        Consecutive frames whose area speaks against `touching`.
    status : int or None
        Bits of the last frame, None before the first.
    """

    touching: bool = False
    differing_frames: int = 0
    status: int | None = None

    def frame(self, area: int, minimum_area: int, debounce: int) -> int:
        """Take the area of a frame; return its status bits."""
        if (area >= minimum_area) == self.touching:
            self.differing_frames = 0
            return TOUCHING * self.touching
        self.differing_frames += 1
        if self.differing_frames < debounce:
            return TOUCHING * self.touching
        self.touching, self.differing_frames = not self.touching, 0
        return TOUCHING | BEGAN if self.touching else ENDED

    def clock(self, *, rst: int, area_valid: int, area: int, minimum_area: int, debounce: int) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        out: dict[str, int | None] = {"touching": self.touching}
        if self.status is not None:
            out |= {"began": bool(self.status & BEGAN), "ended": bool(self.status & ENDED)}
        if rst:
            self.touching, self.differing_frames, self.status = False, 0, None
            return out
        if area_valid:
            self.status = self.frame(area, minimum_area, debounce)
        return out | {"touching_next": self.touching}
