# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/contact/beat_peak.sv: the largest of the depths that leave together."""

from __future__ import annotations

from collections.abc import Sequence


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
