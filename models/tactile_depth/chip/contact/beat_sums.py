# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/contact/beat_sums.sv: count, weight, moment and limits of depths that leave together."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import asdict, dataclass

from tactile_depth.chip.fixed_point import split


@dataclass(frozen=True)
class BeatSums:
    """Depths of a beat that are above. The moment counts from the last; limits are None if none is above."""

    count: int
    weight: int
    moment: int
    least_offset: int | None
    greatest_offset: int | None


def latency(lanes: int) -> int:
    """Return the levels of the tree, a register in each."""
    return lanes.bit_length() - 1


def beat_sums(weights: Sequence[int]) -> BeatSums:
    """Return the sums of the depths that are above; the weight of the others is 0."""
    offsets = [offset for offset, weight in enumerate(weights) if weight]
    moment = sum(weight * (len(weights) - 1 - offset) for offset, weight in enumerate(weights))
    first, last = (offsets[0], offsets[-1]) if offsets else (None, None)
    return BeatSums(len(offsets), sum(weights), moment, first, last)


class SumsOfBeats:
    """Sums on their way, of a core that has seen beats of nothing above."""

    def __init__(self, width: int, lanes: int) -> None:
        self.width, self.lanes = width, lanes
        self._late = deque([beat_sums([0] * lanes)] * latency(lanes))

    def clock(self, *, weights: int) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        sums = self._late.popleft()
        self._late.append(beat_sums(split(weights, self.lanes, self.width)))
        return asdict(sums)
