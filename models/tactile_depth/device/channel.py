# SPDX-License-Identifier: Apache-2.0
"""Channel to a device: what `Device` needs of a link, whatever carries it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

from tactile_depth.base.npy import Bytes
from tactile_depth.chip.link.depth_frames import DepthFrame
from tactile_depth.chip.link.packets import Status


class Arrival(NamedTuple):
    """A depth frame.

    Attributes
    ----------
    frame : DepthFrame
    time_s : float
        When its last bytes came, as `time.time`.
    lost : int
        Frames lost before it.
    """

    frame: DepthFrame
    time_s: float
    lost: int


class Channel(Protocol):
    """Channel to a device, for one thread. Each method raises DeviceError for what fails on the way."""

    @property
    def broken(self) -> bool:
        """True if the channel must be opened anew."""

    @property
    def status(self) -> Status:
        """Last status."""

    @property
    def bad_packets(self) -> int:
        """Broken packets that came."""

    @property
    def delivered(self) -> int:
        """Depth frames that came whole."""

    @property
    def lost(self) -> int:
        """Depth frames that did not come whole or were not taken in time, and pictures without depth."""

    @property
    def quiet_s(self) -> float:
        """Time in which a camera of the device gives a picture, as a rule; then one is sent."""

    @property
    def depth_s(self) -> float:
        """Time in which the depth of a picture that was sent comes, as a rule."""

    @property
    def limit_s(self) -> float:
        """Time after which the depth of a picture that was sent, or an effect of it, does not come any more."""

    def check(self) -> None:
        """Raise what has happened since the last call, once."""

    def ask(self) -> Status:
        """Return the status of the device as it is now; frames that got lost before it are then counted."""

    def read(self, addresses: Sequence[int]) -> list[int]:
        """Return the words of registers at byte addresses; fewer if one was refused."""

    def write(self, pairs: Sequence[tuple[int, int]]) -> int:
        """Write pairs of byte address and word, and return the number of those done: fewer if one was refused."""

    def send(self, pixels: Bytes) -> None:
        """Send a picture of the grid, uint8 (rows, columns, 3)."""

    def collect(self, on: bool) -> None:
        """Begin or end to keep frames; those that wait are dropped."""

    def frame(self, timeout_s: float, lost: int) -> Arrival | None:
        """Return the next depth frame; None at the time-out, or as soon as another number than `lost` are lost."""

    def count_lost(self) -> None:
        """Count a picture that gave no depth as lost."""

    def close(self) -> None:
        """Free what carries the channel; closing twice does nothing."""
