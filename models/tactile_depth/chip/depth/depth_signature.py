# SPDX-License-Identifier: Apache-2.0
"""Cycle-accurate model of hdl/depth/depth_signature.sv."""

from __future__ import annotations

from tactile_depth.chip.common.signature import START, signature_step
from tactile_depth.chip.fixed_point import codes

NO_BEAT = (0, 0, [0])


class DepthSignature:
    """The beat that came last: its two marks and its codes; the signature so far, and whether its frame has ended."""

    def __init__(self, width: int, lanes: int) -> None:
        self.width, self.lanes = width, lanes
        self.beat: tuple | None = None
        self.sum, self.complete = START, False

    def clock(
        self, *, rst: int, en: int, clear: int, in_valid: int, in_frame_start: int, in_frame_end: int, in_data: int
    ) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it."""
        out = {"signature": self.sum if self.complete else 0}
        if self.beat is not None:
            starts, self.complete, words = self.beat
            self.sum = START if starts else self.sum
            for word in words:
                self.sum = signature_step(self.sum, word)
        if rst or clear:
            self.complete = False
        words = codes(in_data, self.lanes, self.width)
        self.beat = (in_frame_start, bool(in_frame_end), words) if en and in_valid and not rst else None
        return out
