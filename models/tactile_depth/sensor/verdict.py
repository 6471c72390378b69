# SPDX-License-Identifier: Apache-2.0
"""The verdict on a calibration, which its file keeps."""

from __future__ import annotations

from dataclasses import dataclass

GRADES = GOOD, USABLE, BAD = ("good", "usable", "bad")


@dataclass(frozen=True)
class Verdict:
    """Verdict on a calibration, from ball presses that were not fitted.

    Attributes
    ----------
    grade : str
        `good`, `usable` or `bad`.
    reasons : tuple of str
        Figures that are not good, each with what is accepted, then likely causes, then what was not checked.
    """

    grade: str
    reasons: tuple[str, ...] = ()

    def __str__(self) -> str:
        return "; ".join((self.grade, *self.reasons))

    @property
    def lines(self) -> str:
        """The same with a line for each reason."""
        return "\n- ".join((self.grade, *self.reasons))
