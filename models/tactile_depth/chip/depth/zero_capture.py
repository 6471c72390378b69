# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/depth/zero_capture.sv: the zero offset of zero_offset from depth without contact."""

from __future__ import annotations

from collections import deque

import numpy as np

from tactile_depth.chip.common import td_node_map
from tactile_depth.chip.common.signature import Captured, signature
from tactile_depth.chip.common.td_block_sum import CYCLES_TO_SUM, block_sum
from tactile_depth.chip.common.td_round_saturate import round_half_even
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.fixed_point import codes, joined, split
from tactile_depth.chip.resources import BLOCK, Memory, Parts, Words

LARGEST_LOG2 = 8
"""Base-2 logarithm of the most frames in a capture; it equals that of reference_capture."""


def levels(lanes: int, block_log2: int) -> int:
    """Return the levels in which the depths of a beat, or of a block, are added up; each takes a cycle."""
    return min(lanes.bit_length() - 1, block_log2)


def cycles(lanes: int, block_log2: int) -> int:
    """Return the cycles from the last beat of the last row of blocks to `done`."""
    return levels(lanes, block_log2) + CYCLES_TO_SUM + 2


def captured_zero(depths: np.ndarray, config: Configuration) -> np.ndarray:
    """Return the mean of each block over frames, rounded with ties to even.

    Parameters
    ----------
    depths : int64 array (2**k, rows, columns)
        Depth before a zero offset is subtracted.

    Returns
    -------
    int64 array (node rows, node columns)
    """
    count = len(depths)
    assert count.bit_count() == 1, "a power of two of frames"
    log2 = count.bit_length() - 1
    sums = block_sum(depths, config.reference_block_log2).sum(axis=0)
    return round_half_even(sums, 2 * config.reference_block_log2 + log2)


class ZeroCapture:
    """Capture from beats of depths.

    Attributes
    ----------
    place, size : int
        Beats that came of the frame; beats of a frame.
    busy : bool
        A capture is asked for, or goes on.
    """

    def __init__(self, rows: int, columns: int, block_log2: int, width: int, largest: int, lanes: int) -> None:
        self._log2, self._width, self._largest, self._lanes = block_log2, width, largest, lanes
        self._side, self._row = td_node_map.side(lanes, block_log2), columns // lanes
        self._columns, self._nodes = columns >> block_log2, (columns >> block_log2) * (rows >> block_log2)
        self.size, self.place, self.busy = rows * self._row, 0, False
        self._beats: deque[tuple[int, int] | None] = deque([None] * levels(lanes, block_log2))
        self._starts = False  # the last frame of a capture began in the clock before
        self._stop()

    def _stop(self) -> None:
        self._inside = self._done = False
        self._frames = self._count = 0
        self._late: deque[tuple[int, int] | None] = deque([None] * (CYCLES_TO_SUM + 1))

    def _take(self, place: int, data: int, log2_frames: int) -> tuple[int, int] | None:
        """Add a beat; return the number and the zero offsets of the nodes that it completes."""
        row, column = place // self._row, place % self._row * self._lanes
        if place == 0:
            self._inside = self.busy and not self._count == self._frames > 0
            if self._inside and not self._frames:
                self._count, self._sums = 1 << min(log2_frames, self._largest), [0] * self._nodes
            self._frames += self._inside
            self._starts = self._inside and self._frames == self._count
        first = (row >> self._log2) * self._columns + (column >> self._log2)
        if not self._inside or first >= self._nodes:
            return None
        sign = 1 << self._width - 1
        for lane, word in enumerate(split(data, self._lanes, self._width)):
            self._sums[first + (lane >> self._log2)] += (word ^ sign) - sign
        ones = (1 << self._log2) - 1
        if self._frames < self._count or row & ones != ones or column + self._lanes & ones:
            return None
        drop = 2 * self._log2 + self._count.bit_length() - 1
        means = round_half_even(np.array(self._sums[first : first + self._side]), drop).tolist()
        return first // self._side, joined(means, self._width)

    def clock(self, **pins: int) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        node, zero = self._late.popleft() or (None, None)
        valid = node is not None and not pins["rst"]
        out: dict[str, int | None] = {"busy": self.busy, "done": self._done, "map_write": valid}
        out |= {"map_write_node": node, "map_write_zero": zero}
        if self._done:
            self._stop()
            self._late.popleft()
            self.busy = False
        self._done = node == self._nodes // self._side - 1
        taken = pins["en"] and pins["in_valid"]
        self._beats.append((self.place, pins["in_data"]) if taken else None)
        beat, starts, self._starts = self._beats.popleft(), self._starts, False
        self._late.append(beat and self._take(*beat, pins["log2_frames"]))
        word = 0 if zero is None else signature(codes(zero, self._side, self._width), 0)
        out["captured"] = Captured(valid, starts, valid, valid and self._done, word).bits
        self.place = (self.place + 1) % self.size if taken else self.place
        if pins["request"] or pins["rst"]:
            self._stop()
            self.busy, self._starts = not pins["rst"], False
        if pins["rst"]:
            self.place = 0
            self._beats = deque([None] * len(self._beats))
        return out


def parts(config: Configuration) -> Parts:
    """Return the sums of nodes that are written at once."""
    log2, (rows, columns) = config.reference_block_log2, config.reference_nodes
    side = td_node_map.side(config.lanes, log2)
    width = side * (config.depth.width + 2 * log2 + LARGEST_LOG2)
    return [Words(config.lanes * config.depth.width), Memory("tables", width, rows * columns // side, BLOCK)]
