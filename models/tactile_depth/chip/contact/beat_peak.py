# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/contact/beat_peak.sv: the largest of the depths that leave together."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

from tactile_depth.chip.fixed_point import codes, split


def latency(lanes: int) -> int:
    """Return the levels of the tree, a register in each."""
    return lanes.bit_length() - 1


def beat_peak(above: Sequence[bool], depths: Sequence[int]) -> tuple[int, int] | None:
    """Return the peak of the depths that are above and its place in the beat, of equal ones the first; else None."""
    offsets = [offset for offset, is_above in enumerate(above) if is_above]
    if not offsets:
        return None
    first = max(offsets, key=lambda offset: (depths[offset], -offset))
    return depths[first], first


class BeatPeak:
    """Peaks on their way, of a core that has seen beats of nothing above."""

    def __init__(self, width: int, lanes: int) -> None:
        self.width, self.lanes = width, lanes
        self._late: deque[tuple[int, int] | None] = deque([None] * latency(lanes))

    def clock(self, *, above: int, data: int) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        peak = self._late.popleft()
        self._late.append(beat_peak(list(map(bool, split(above, self.lanes, 1))), codes(data, self.lanes, self.width)))
        return {"any": 0} if peak is None else {"any": 1, "peak": peak[0], "peak_offset": peak[1]}
