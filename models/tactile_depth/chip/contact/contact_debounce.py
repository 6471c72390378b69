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
    """

    touching: bool = False
    differing_frames: int = 0

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

    def reset(self) -> None:
        """Advance by one clock edge in reset."""
        self.touching, self.differing_frames = False, 0
