# SPDX-License-Identifier: Apache-2.0
"""Depth frames that `tactile-depth live` shows, from the package or from a device, and captures of both."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from typing import NamedTuple, Protocol

import numpy as np

from tactile_depth.base.errors import InputError
from tactile_depth.cli.source import Counts, Frame
from tactile_depth.depth.pipeline import Pipeline
from tactile_depth.depth.result import Result
from tactile_depth.device.device import Device
from tactile_depth.device.frame import DeviceFrame
from tactile_depth.pictures.doubts import UnusablePicture
from tactile_depth.pictures.picture_check import check_picture


class Shot(NamedTuple):
    """A depth frame to be shown.

    Attributes
    ----------
    number : int
        Number of the frame in its source.
    image : uint8 array (rows, columns, 3), or None
        The camera picture; None for that of a device's own camera, which the link does not carry.
    depth : Result or DeviceFrame
    """

    number: int
    image: np.ndarray | None
    depth: Result | DeviceFrame


class Feed(Protocol):
    """Depth frames as they come.

    Attributes
    ----------
    counts : Counts
    takes_pictures : bool
        `capture` needs pictures.
    """

    counts: Counts
    takes_pictures: bool

    def shots(self) -> Iterator[Shot | None]:
        """Give depth frames; None when none has arrived for a while."""

    def capture(self, images: Sequence[np.ndarray], reference: bool) -> None:
        """Make pictures without contact the reference, and after it the zero offset, or the zero offset alone."""

    def end(self) -> None:
        """Count what is known at the end alone."""


class PackageFeed:
    """Depth of the pictures of a source, computed by the package."""

    takes_pictures = True

    def __init__(self, frames: Iterator[Frame | None], pipeline: Pipeline, counts: Counts) -> None:
        self.counts = counts
        self._frames, self._pipeline = frames, pipeline

    def shots(self) -> Iterator[Shot | None]:
        is_first, stream = True, self._pipeline.new_stream()
        for frame in self._frames:
            if frame is None:
                yield None
                continue
            try:
                result = self._pipeline(frame.image, stream, f"frame {frame.index}", frame.captured_at)
            except InputError as error:
                if is_first and not isinstance(error, UnusablePicture):
                    raise
                self.counts.fail(error)
                continue
            is_first = False
            yield Shot(frame.index, frame.image, result)

    def capture(self, images: Sequence[np.ndarray], reference: bool) -> None:
        _capture(self._pipeline, stacked(images), reference)

    def end(self) -> None:
        pass


class SentFeed:
    """Depth of the pictures of a source, sent to a device and computed there.

    A capture goes to the pipeline as well, which checks the pictures. After it, light gains begin at 1 again.
    """

    takes_pictures = True

    def __init__(self, frames: Iterator[Frame | None], device: Device, counts: Counts) -> None:
        self.counts = counts
        self._frames, self._device = frames, device
        self._sent: list[Frame] = []  # pictures of this stream
        self._is_first = True
        self._captured = False
        self._depth: Iterator[DeviceFrame] = iter(())

    def shots(self) -> Iterator[Shot | None]:
        while True:
            self._sent, self._captured, shown = [], False, 0
            self._depth = self._device.depth(self._pictures())
            for depth in self._depth:
                assert depth.picture is not None
                frame = self._sent[depth.picture]
                self.counts.lost += depth.picture - shown
                shown = depth.picture + 1
                yield Shot(frame.index, frame.image, depth)
                if self._captured:
                    break
            self.counts.lost += len(self._sent) - shown
            if not self._captured:
                return

    def _pictures(self) -> Iterator[np.ndarray]:
        """Give the pictures that the device shall get; count those that give no depth."""
        rest = self._device.pipeline.rest
        for frame in self._frames:
            if frame is None:
                continue
            try:
                ((name, on_grid),) = self._device.pipeline.reader.pictures(frame.image, f"frame {frame.index}")[0]
                check_picture(on_grid, rest, name)
            except InputError as error:
                if self._is_first and not isinstance(error, UnusablePicture):
                    raise
                self.counts.fail(error)
                continue
            self._is_first = False
            self._sent.append(frame)
            yield frame.image

    def capture(self, images: Sequence[np.ndarray], reference: bool) -> None:
        pictures = stacked(images)
        _capture(self._device.pipeline, pictures, reference)
        self._captured = True
        _end(self._depth)
        _capture(self._device, pictures, reference)

    def end(self) -> None:
        pass


class CameraFeed:
    """Depth of a device's own camera."""

    takes_pictures = False

    def __init__(self, device: Device) -> None:
        self.counts = Counts()
        self._device = device
        self._captured = False
        self._skipped = device.status().skipped
        self._depth: Iterator[DeviceFrame] = iter(())

    def shots(self) -> Iterator[Shot | None]:
        lost = self._device.status().lost
        while True:
            self._captured = False
            self._depth = self._device.depth()
            for depth in self._depth:
                self.counts.lost += depth.lost - lost
                self.counts.taken += depth.lost - lost + 1
                lost = depth.lost
                yield Shot(depth.number, None, depth)
                if self._captured:
                    break
            lost = self._device.status().lost  # frames of the capture are not shown

    def end(self) -> None:
        _end(self._depth)
        self.counts.dropped += self._device.status().skipped - self._skipped

    def capture(self, images: Sequence[np.ndarray], reference: bool) -> None:
        self._captured = True
        _end(self._depth)
        capture_of_camera(self._device, reference)


def capture_of_camera(device: Device, reference: bool) -> None:
    """Capture the reference, if it is wanted and the pipeline has one, and the zero offset of a device's camera."""
    config = device.pipeline.config
    if reference and config.flat_field:
        device.capture_reference()
    if config.zero_offset or not reference:
        device.capture_zero()


def _end(frames: Iterator[DeviceFrame]) -> None:
    """End a stream of a device, so that a capture can follow."""
    if isinstance(frames, Generator):
        frames.close()


def stacked(images: Sequence[np.ndarray]) -> np.ndarray:
    """Return pictures in one array; raise InputError if their sizes differ."""
    if len({image.shape for image in images}) > 1:
        raise InputError("the pictures have several sizes: give pictures of one camera")
    return np.stack(images)


def _capture(target: Pipeline | Device, pictures: np.ndarray, reference: bool) -> None:
    config = target.config if isinstance(target, Pipeline) else target.pipeline.config
    if reference:
        target.capture_reference(pictures)
    if config.zero_offset or not reference:
        target.capture_zero(pictures)
