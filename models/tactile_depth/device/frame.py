# SPDX-License-Identifier: Apache-2.0
"""Depth frames of a device in mm."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from tactile_depth.base.by_value import ByValue
from tactile_depth.base.npy import Codes, Flags, Floats
from tactile_depth.chip.contact.contact_events import Record
from tactile_depth.chip.contact.frame_flags import FrameFlags
from tactile_depth.chip.link.depth_formats import FORMATS, DepthFormatName, span_of
from tactile_depth.depth.result import Contact, Recorder, Result
from tactile_depth.pictures.doubts import Doubt, doubt, tell


@dataclass(frozen=True, eq=False)
class DeviceFrame(ByValue):
    """Depth frame of a device. Rows are in the order of the picture; depth is positive where the gel is pressed in.

    Heights, depths and the mask are those that a `Result` of the same codes and threshold has. The contact is that of
    the grid of the device, also where the depth is averaged. Two frames are equal if all their values are.

    Attributes
    ----------
    codes : int32 array (rows, columns)
        Depth codes; with the format `averaged` half as many rows and columns as the grid has, rounded down.
    record : Record
        Contact record that the device made, with the frame's number and time in the pipeline.
    number : int
        Number of the frame on the link, from 1 at power-up, modulo 2^32; over `uio` that of its record, from 1 at a
        reset. A frame that is lost has a number too.
    time_s : float
        Time at which the last bytes of the frame came, in seconds since the epoch, as `time.time` gives it.
    lost : int
        Frames lost from the opening of the device to this frame, as `DeviceStatus.lost`.
    picture : int or None
        Number of its picture among those that `Device.depth` was given, from 0; None for a picture of the device's
        camera.
    recorder : Recorder
        Holds the thresholds.
    depth_lsb_mm, pixel_pitch_mm : float
        Depth of code 1 in mm, and height of a pixel of `codes`: with the format `averaged` of two grid pixels.
    pixel_aspect : float
        Width of a pixel over its height.
    depth_format : str
        Format in which the depth came: `words`, `16-bit` or `averaged`.
    grid : tuple of int
        Rows and columns of the device, in whose pixels `record` counts.
    warnings : tuple of str
        Why the heights are uncertain, as of a `Result`: empty if nothing is known against them. The host does not see
        the pictures of the device's camera: what its flags and the depth say of one.
    saturations : dict of str to int, or None
        Values clipped, by node; None: not known, for a picture of the device's camera.
    dark, outside : bool array (rows, columns), or None
        Pixels without light, and those whose slopes lie outside the calibrated range: of averaged depth the values with
        such a pixel; None: not known, but `flags` count them.
    light_gains : float64 array (3,), or None
        Light of the reference over that of the picture, of red, green and blue; None without light gains.
    """

    codes: Codes
    record: Record
    number: int
    time_s: float
    lost: int
    picture: int | None
    recorder: Recorder
    depth_lsb_mm: float
    pixel_pitch_mm: float
    pixel_aspect: float
    depth_format: DepthFormatName
    grid: tuple[int, int]
    warnings: tuple[str, ...] = ()
    saturations: dict[str, int] | None = None
    dark: Flags | None = None
    outside: Flags | None = None
    light_gains: Floats | None = None

    def __repr__(self) -> str:
        rows, columns = self.codes.shape
        return f"DeviceFrame({self.number}, {columns}x{rows}, height up to {self.height_mm.max():.3g} mm)"

    @cached_property
    def _result(self) -> Result:
        return self._result_of(self.codes, self.pixel_pitch_mm)

    def _result_of(self, codes: Codes, pixel_pitch_mm: float) -> Result:
        """Return the result of codes, with the record of the device; without slopes."""
        return Result(
            codes,
            np.multiply(codes, self.depth_lsb_mm, dtype=np.float64),
            np.full((*codes.shape, 2), np.nan),
            np.broadcast_to(np.False_, codes.shape),
            None,
            {},
            self.recorder,
            self.depth_lsb_mm,
            pixel_pitch_mm,
            math.inf,
            None,
            (self.record,),
            pixel_aspect=self.pixel_aspect,
        )

    @cached_property
    def height_mm(self) -> npt.NDArray[np.float32]:
        """Height above the untouched surface in mm, float32 (rows, columns): `Result.height_mm`, rounded once."""
        return self._result.height_mm.astype(np.float32)

    @property
    def flags(self) -> FrameFlags:
        """Flags that the device gave with the frame: what it clipped, its light gains, dark and steep pixels."""
        return self.record.flags

    @property
    def depth_mm(self) -> Floats:
        """Depth in mm, float64 (rows, columns)."""
        return self._result.depth_mm

    @property
    def untouched_mm(self) -> float:
        """Mean of the depths that are not above the threshold, in mm; NaN without such a pixel."""
        return float(self._result.untouched_mm)

    @property
    def threshold_mm(self) -> float:
        """Depth above which a pixel touches, in mm."""
        return self._result.threshold_mm

    @property
    def mask(self) -> Flags:
        """Pixels whose depth is above the threshold, bool (rows, columns)."""
        return self._result.mask

    @cached_property
    def contact(self) -> Contact:
        """Contact, with the record that the device made, in pixels of the grid; `mask` is that of the frame."""
        return replace(self._result.contact, pixel_pitch_mm=self.pixel_pitch_mm / self._span, grid=self.grid)

    @cached_property
    def contacts(self) -> list[Contact]:
        """Contacts, that with most pixels first: `Result.contacts` of the depth map, in pixels of the grid."""
        codes = self.codes
        if self._span > 1:
            codes = codes.repeat(self._span, axis=0).repeat(self._span, axis=1)
            rows, columns = (whole - sent for whole, sent in zip(self.grid, codes.shape, strict=True))
            codes = np.pad(codes, ((self._first_row, rows - self._first_row), (0, columns)), mode="edge")
        return self._result_of(codes, self.pixel_pitch_mm / self._span).contacts

    @property
    def origin_mm(self) -> tuple[float, float]:
        """Row and column of the first value from the upper left corner of the picture, in mm, as `Contact` counts.

        It is (0, 0), but with the format `averaged` the middle of the grid pixels whose mean the value is. The value of
        row r and column c lies r * `pixel_pitch_mm` below it and c * `pixel_pitch_mm` * `pixel_aspect` to the right.
        """
        middle = (self._span - 1) / 2
        pitch_mm = self.pixel_pitch_mm / self._span
        return (self._first_row + middle) * pitch_mm, middle * pitch_mm * self.pixel_aspect

    @property
    def _first_row(self) -> int:
        """Row of the grid at which the depth begins: the last row to leave is not sent if it has no other."""
        return self.grid[0] % self._span if self.recorder.bottom_first else 0

    @property
    def _span(self) -> int:
        return span_of(FORMATS[self.depth_format])


def seen_as(frame: DeviceFrame, result: Result) -> DeviceFrame:
    """Return a frame with what the package knows of its picture."""
    (rows, columns), span, first = frame.codes.shape, frame._span, frame._first_row

    def of_values(pixels: Flags) -> Flags:
        sent = pixels[first:][: span * rows]
        return np.asarray(sent.reshape(rows, span, columns, span).any(axis=(1, 3)))

    errors = errors_of(frame)
    tell(errors)
    known = {name: getattr(result, name) for name in ("saturations", "light_gains")}
    known["warnings"] = (*result.warnings, *map(str, errors))
    return replace(frame, dark=of_values(result.dark), outside=of_values(result.outside), **known)


def errors_of(frame: DeviceFrame) -> list[Doubt]:
    """Doubt a frame whose flags say that the device computed it wrongly."""
    flags, name, found = frame.flags, f"frame {frame.number}", []
    if flags.flipped:
        text = ": a bit of the device had flipped while it was computed"
        remedy = "take another; if all are so, write the tables of the device again, or reset it"
        found.append(doubt("flipped", name, text, remedy=remedy))
    if flags.residual and not flags.depth_clipped:  # clipped depth solves no equation
        text = ": the depth that the device computed does not fit its slopes"
        remedy = "take another; if all are so, reset the device, and see that its clock is not too fast"
        found.append(doubt("residual", name, text, remedy=remedy))
    return found
