# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/contact/beat_sums.sv: count, sums, limits and peak of depths that leave together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class BeatSums:
    """Depths of a beat that are above; offsets are places in the beat. Limits and peak are None if none is above."""

    count: int
    offset_sum: int
    volume: int
    peak: int | None
    peak_offset: int | None
    least_offset: int | None
    greatest_offset: int | None


def latency(lanes: int) -> int:
    """Return the levels of the tree, a register in each."""
    return lanes.bit_length() - 1


def beat_sums(above: Sequence[bool], depths: Sequence[int]) -> BeatSums:
    """Return the sums of the depths that are above."""
    offsets = [offset for offset, is_above in enumerate(above) if is_above]
    if not offsets:
        return BeatSums(0, 0, 0, None, None, None, None)
    peak = max(depths[offset] for offset in offsets)
    first = next(offset for offset in offsets if depths[offset] == peak)
    volume = sum(depths[offset] for offset in offsets)
    return BeatSums(len(offsets), sum(offsets), volume, peak, first, offsets[0], offsets[-1])
