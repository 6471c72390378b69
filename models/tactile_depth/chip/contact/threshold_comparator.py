# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/contact/threshold_comparator.sv."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from tactile_depth.chip.fixed_point import codes

LATENCY = 1  # from the depth value that raises contact


def above(depths: Sequence[int], threshold: int | None) -> int:
    """Return a bit for each depth of a beat, 1 if it is above the threshold, the first in the lowest bit."""
    assert threshold is not None
    return sum((depth > threshold) << lane for lane, depth in enumerate(depths))


@dataclass
class ThresholdComparator:
    """State of the `contact` output, cycle by cycle.

    Attributes
    ----------
    contact : bool
        Value of the output in the cycle after the last one that was taken.
    raised : bool
        True if a depth code of the current frame was above the threshold.
    threshold : int or None
        Threshold of the current frame; None before the first frame.
    width, lanes : int
        Bits of a depth code, and codes in a beat.
    """

    contact: bool = False
    raised: bool = False
    threshold: int | None = None
    width: int = 32
    lanes: int = 1

    def beat(self, data: int, user: bool, threshold: int, hold: bool) -> None:
        """Take a depth code that leaves.

        Parameters
        ----------
        user : bool
            True for the first code of a frame.
        threshold, hold : int, bool
            Registers in that cycle. The threshold takes effect only with the first code of a frame.

        Raises
        ------
        ValueError
            No frame has begun, so the threshold of the device is unknown.
        """
        if user:
            self.threshold = threshold
        if self.threshold is None:
            raise ValueError("a depth code left before the first of any frame")
        self.raised = data > self.threshold or (self.raised and not user)
        self.idle(hold)

    def idle(self, hold: bool) -> None:
        """Take a cycle in which no depth code leaves."""
        self.contact = self.raised or (hold and self.contact)

    def reset(self) -> None:
        """Advance by one clock edge in reset, which clears `contact` and keeps the threshold, as the device does."""
        self.contact = self.raised = False

    def clock(
        self, *, rst: int, in_valid: int, in_frame_start: int, in_data: int, threshold: int, hold: int
    ) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it."""
        out: dict[str, int | None] = {"contact": self.contact}
        if in_valid:
            depths = codes(in_data, self.lanes, self.width)
            (level,) = codes(threshold, 1, self.width + 1)
            self.beat(max(depths), bool(in_frame_start), level, bool(hold))
            out["above"] = above(depths, self.threshold)
        else:
            self.idle(bool(hold))
        if rst:
            self.reset()
        return out
