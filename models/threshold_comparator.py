# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/threshold_comparator.sv."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass
class ThresholdComparator:
    """`contact`, beat by beat.

    Attributes
    ----------
    contact : bool
        In the clock after the last beat, and until the clock after the next.
    threshold : int or None
        That of the frame that is leaving; None: no frame has begun.
    """

    contact: bool = False
    threshold: int | None = None

    def beat(self, data: int, user: bool, threshold: int, hold: bool) -> None:
        """One depth code leaves.

        Parameters
        ----------
        user : bool
            It is the first of its frame.
        threshold, hold : int, bool
            The registers in that clock. The threshold counts with a first beat only.

        Raises
        ------
        ValueError
            No frame has begun: the device's threshold is unknown.
        """
        if user:
            self.threshold = threshold
        if self.threshold is None:
            raise ValueError("a depth code left before the first of any frame")
        if data > self.threshold:
            self.contact = True
        elif user and not hold:
            self.contact = False

    def reset(self) -> None:
        """One edge in reset: contact falls. The threshold stays, as it does in the device."""
        self.contact = False
