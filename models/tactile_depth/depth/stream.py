# SPDX-License-Identifier: Apache-2.0
"""State of a stream of pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from tactile_depth.base.errors import Argument, InputError, InputWarning, is_number, warn
from tactile_depth.chip.contact.contact_events import ContactEvents
from tactile_depth.chip.gradient.light_gains import LightFilter
from tactile_depth.depth.result import Recorder
from tactile_depth.pictures.doubts import UnusablePicture, Warned
from tactile_depth.pictures.pictures import Picture


@dataclass
class Stream:
    """State that a stream of pictures leaves for its next one.

    Attributes
    ----------
    recorder : Recorder
        That of the pipeline when the stream began; a capture gives it another one.
    light : LightFilter or None
        Light gains; None for a pipeline without them.
    events : ContactEvents
        Whether something touches, and the last peak.
    taken, failed : int
        Pictures that `Pipeline.stream` took, and those of them that it refused and left out.
    warned : Warned
        Warnings that were given.
    """

    recorder: Recorder
    light: LightFilter | None
    events: ContactEvents
    taken: int = 0
    failed: int = 0
    warned: Warned = field(default_factory=Warned)

    def begin_as(self, new: Stream) -> None:
        """Begin afresh, after a capture: the light that the gains followed, and what is no contact, are others."""
        self.recorder, self.light, self.events = new.recorder, new.light, new.events

    def leave_out(self, error: InputError) -> None:
        """Count a picture that gives no right depth, and warn of the first.

        Raises
        ------
        InputError
            None before it gave depth, and it is the kind of picture that is wrong: so will all that follow be.
        """
        if self.failed == self.taken - 1 and not isinstance(error, UnusablePicture):
            raise error
        self.failed += 1
        if self.failed == 1:
            warn(InputWarning("left out and counted: ", *error.parts))


def timed(item: Picture | tuple[Picture, float]) -> tuple[Picture, float | None]:
    """Return a picture of a stream and when it was captured."""
    if isinstance(item, tuple):
        if len(item) != 2 or not is_number(item[1]):
            raise InputError(Argument("pictures"), " have a tuple", accepted="a picture, or a picture and its seconds")
        return item
    return item, None


def times(captured_at: float | Sequence[float] | np.ndarray | None, frames: int) -> np.ndarray | None:
    """Return the capture time of each frame, float64 (frames,); None if it is not known."""
    if captured_at is None:
        return None
    seconds = np.asarray(captured_at)
    if seconds.dtype.kind not in "iuf" or seconds.shape not in ((), (frames,)):
        accepted = "seconds since the epoch, one number or one for each picture"
        raise InputError(Argument("captured_at", captured_at), accepted=accepted)
    return np.full(frames, seconds, np.float64)
