# SPDX-License-Identifier: Apache-2.0
"""Depth frames of a device in mm."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from tactile_depth.by_value import ByValue
from tactile_depth.result import Contact, Result


@dataclass(frozen=True, eq=False)
class DeviceFrame(ByValue):
    """Depth frame of a device. Rows are in the order of the picture; depth is positive where the gel is pressed in.

    Heights, depths and the mask are those that `Result` of the same codes and threshold has. Two frames are equal if
    all their values are.

    Attributes
    ----------
    result : Result
        Depth codes and the record of the device, with the units of the pipeline; without slopes, `dark` and warnings.
    number : int
        Number of the frame on the link, from 1 at power-up, modulo 2^32. Frames that are lost have numbers too.
    time_s : float
        Time at which the last bytes of the frame came, in seconds since the epoch, as `time.time` gives it.
    lost : int
        Frames lost since the device was opened: as `DeviceStatus.lost`, at this frame.
    picture : int or None
        Number of its picture among those that `Device.depth` was given, from 0; None for a picture of the device's
        camera.
    """

    result: Result
    number: int
    time_s: float
    lost: int
    picture: int | None = None

    def __repr__(self) -> str:
        rows, columns = self.codes.shape
        return f"DeviceFrame({self.number}, {columns}x{rows}, height up to {self.height_mm.max():.3g} mm)"

    @property
    def codes(self) -> npt.NDArray[np.int32]:
        """Depth codes, int32 (rows, columns)."""
        return self.result.codes

    @property
    def depth_mm(self) -> npt.NDArray[np.float64]:
        """Depth in mm, float64 (rows, columns)."""
        return self.result.depth_mm

    @cached_property
    def height_mm(self) -> npt.NDArray[np.float32]:
        """Height above the untouched surface in mm, float32 (rows, columns): `Result.height_mm`, rounded once."""
        return self.result.height_mm.astype(np.float32)

    @property
    def untouched_mm(self) -> float:
        """Mean of the depths that are not above the threshold, in mm; NaN without such a pixel."""
        return float(self.result.untouched_mm)

    @property
    def mask(self) -> npt.NDArray[np.bool_]:
        """Pixels whose depth is above the threshold, bool (rows, columns)."""
        return self.result.mask

    @property
    def contact(self) -> Contact:
        """Contact, with the record that the device made."""
        return self.result.contact
