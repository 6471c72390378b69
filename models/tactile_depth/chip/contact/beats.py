# SPDX-License-Identifier: Apache-2.0
"""A beat of depth codes as it leaves the pipeline: neighbours of a row, and what the beat is in its frame."""

from __future__ import annotations

from collections.abc import Iterator

from tactile_depth.chip.fixed_point import codes


def marked(data: int, position: int, lanes: int, width: int) -> Iterator[tuple[int, bool, bool, bool]]:
    """Yield each depth code of a beat, whether a frame begins with it, and whether a row and a frame end with it."""
    start, row_end, frame_end = (bool(position & mark) for mark in (4, 2, 1))
    for lane, depth in enumerate(codes(data, lanes, width)):
        last = lane == lanes - 1
        yield depth, start and lane == 0, row_end and last, frame_end and last
