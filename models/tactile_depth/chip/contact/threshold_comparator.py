# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/contact/threshold_comparator.sv."""

from __future__ import annotations

from dataclasses import dataclass

LATENCY = 1  # from the depth value that raises contact


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
    """

    contact: bool = False
    raised: bool = False
    threshold: int | None = None

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
