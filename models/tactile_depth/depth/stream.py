# SPDX-License-Identifier: Apache-2.0
"""State of a stream of pictures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from tactile_depth.base.errors import Argument, InputError, InputWarning, is_number, warn
from tactile_depth.chip.contact.contact_events import ContactEvents
from tactile_depth.chip.gradient.light_gains import LightFilter
from tactile_depth.pictures.doubts import UnusablePicture, Warned
from tactile_depth.pictures.pictures import Picture


@dataclass
class Stream:
    """State that a stream of pictures leaves for its next one.

    Attributes
    ----------
    pipeline : str
        Key of the pipeline that it belongs to.
    captures : int
        Captures of the pipeline before the stream began.
    light : LightFilter or None
        Light gains; None for a pipeline without them.
    events : ContactEvents
        Whether something touches, and the last peak.
    taken, failed : int
        Pictures that `Pipeline.stream` took, and those of them that it refused and left out.
    warned : Warned
        Warnings that were given.
    accepted : bool
        A picture was accepted.
    """

    pipeline: str
    captures: int
    light: LightFilter | None
    events: ContactEvents
    taken: int = 0
    failed: int = 0
    warned: Warned = field(default_factory=Warned)
    accepted: bool = False

    def require(self, pipeline: str) -> None:
        """Raise InputError unless the stream belongs to the pipeline with this key."""
        if self.pipeline != pipeline:
            raise InputError(Argument("stream"), " is of another pipeline", remedy="call new_stream() of this one")

    def begin_as(self, new: Stream) -> None:
        """Begin afresh, after a capture: the light that the gains followed, and what is no contact, are others."""
        self.captures, self.light, self.events, self.warned = new.captures, new.light, new.events, new.warned

    def leave_out(self, error: InputError) -> None:
        """Count a picture that is refused, and warn of the first.

        Raises
        ------
        InputError
            No picture was accepted, and this is no picture of the sensor: those that follow will not be either.
        """
        if not self.accepted and not isinstance(error, UnusablePicture):
            raise error
        self.failed += 1
        if self.failed == 1:
            warn(InputWarning("left out and counted: ", *error.parts))


def require_stream(stream: Stream | None) -> Stream | None:
    """Return a stream that a user gave, or None; raise InputError for anything else."""
    if stream is None or isinstance(stream, Stream):
        return stream
    remedy = "make one with `pipeline.new_stream()`, and give it with each of its pictures"
    raise InputError(Argument("stream"), f" is a {type(stream).__name__}", accepted="a Stream", remedy=remedy)


def timed(item: Picture | tuple[Picture, float]) -> tuple[Picture, float | None]:
    """Return a picture of a stream and when it was captured."""
    if isinstance(item, tuple):
        if len(item) != 2 or not is_number(item[1]) or not math.isfinite(item[1]):
            raise InputError(Argument("pictures"), " have a tuple", accepted="a picture, or a picture and its seconds")
        return item
    return item, None


def times(captured_at: float | Sequence[float] | np.ndarray | None, frames: int) -> np.ndarray | None:
    """Return the capture time of each frame, float64 (frames,); None if it is not known."""
    if captured_at is None:
        return None
    seconds = np.asarray(captured_at)
    is_time = seconds.dtype.kind in "iuf" and seconds.shape in ((), (frames,))
    if not is_time or not np.isfinite(seconds).all():
        accepted = "seconds since the epoch, one number or one for each picture"
        raise InputError(Argument("captured_at", captured_at), accepted=accepted)
    return np.full(frames, seconds, np.float64)
