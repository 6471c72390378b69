# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/contact/beat_peak.sv: the largest of the depths that leave together."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

from tactile_depth.chip.fixed_point import codes


def latency(lanes: int) -> int:
    """Return the levels of the tree, a register in each."""
    return lanes.bit_length() - 1


def beat_peak(depths: Sequence[int]) -> tuple[int, int]:
    """Return the peak of the depths and its place in the beat, of equal ones the first."""
    peak = max(depths)
    return peak, depths.index(peak)


class BeatPeak:
    """Peaks on their way, of a core that has seen beats of depths 0."""

    def __init__(self, width: int, lanes: int) -> None:
        self.width, self.lanes = width, lanes
        self._late = deque([(0, 0)] * latency(lanes))

    def clock(self, *, data: int) -> dict[str, int]:
        """Advance by one clock edge; return the outputs before it."""
        peak, offset = self._late.popleft()
        self._late.append(beat_peak(codes(data, self.lanes, self.width)))
        return {"peak": peak, "peak_offset": offset}
