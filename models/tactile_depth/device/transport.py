# SPDX-License-Identifier: Apache-2.0
"""Transports: they carry the bytes of a line to a device and back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True)
class Pace:
    """Times of a line, in seconds.

    Attributes
    ----------
    repeat_s : float
        A request without a reply is repeated after this time.
    limit_s : float
        A device that has not answered by then does not answer.
    look_s : float
        A device that has not sent the depth of a picture after this time, beside the time on the line, is asked about
        it.
    byte_s : float
        Time that a byte takes on the line.
    """

    repeat_s: float
    limit_s: float
    look_s: float
    byte_s: float = 0.0


class Transport(Protocol):
    """Bytes of a line, in order. One thread reads while another writes.

    Attributes
    ----------
    name : str
        Names the line in errors.
    silence : str
        Likely causes of a device that answers nothing, and how to mend them.
    pace : Pace
    """

    name: str
    silence: str
    pace: Pace

    def read(self, timeout_s: float) -> bytes:
        """Return bytes of the device as soon as some are there; none at the time-out.

        Raises
        ------
        DeviceError
            The line is gone.
        """

    def write(self, data: bytes) -> None:
        """Send bytes to the device. Raises DeviceError if the line is gone or takes no bytes."""

    def close(self) -> None:
        """Free the line; closing twice does nothing."""
