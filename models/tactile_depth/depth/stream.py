# SPDX-License-Identifier: Apache-2.0
"""State of a stream of pictures."""

from __future__ import annotations

from dataclasses import dataclass, field

from tactile_depth.chip.contact.contact_events import ContactEvents
from tactile_depth.chip.gradient.light_gains import LightFilter
from tactile_depth.pictures.doubts import Warned


@dataclass
class Stream:
    """State that a stream of pictures leaves for its next one.

    Attributes
    ----------
    light : LightFilter or None
        Light gains; None for a pipeline without them.
    events : ContactEvents
        Whether something touches, and the last peak.
    taken, failed : int
        Pictures that `Pipeline.stream` took, and those of them that it refused and left out.
    warned : Warned
        Warnings that were given.
    """

    light: LightFilter | None
    events: ContactEvents
    taken: int = 0
    failed: int = 0
    warned: Warned = field(default_factory=Warned)
