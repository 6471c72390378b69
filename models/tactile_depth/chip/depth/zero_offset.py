# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/depth/zero_offset.sv: depth minus the zero offset.

The zero offset is the depth that a pixel reads without contact. Lights and gel drift, and the remaining slope errors
add up to a zero offset that is not flat. It is smooth, so a coarse grid of block means holds it: the grid of the
reference frame (flat_field.py). The means are interpolated between the centres of the blocks (td_node_map). Codes are
depth codes. Rows are in the order of the stream, and nodes run row by row in the same order.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tactile_depth.chip.common import td_node_map
from tactile_depth.chip.common.td_block_sum import block_sum
from tactile_depth.chip.common.td_node_map import interpolated, node_map
from tactile_depth.chip.common.td_round_saturate import Monitor, round_saturate
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.fixed_point import joined, split
from tactile_depth.chip.registers.register_map import TABLES
from tactile_depth.chip.resources import DEPTH_MARKS, Multiplier, Parts, Words, banks, delay_line


def no_zero(config: Configuration) -> np.ndarray:
    """Return the zero offset at power-up of a build without an initial one: int64 zeros (node rows, node columns)."""
    return np.zeros(config.reference_nodes, np.int64)


def zero_offset(
    codes: np.ndarray, zero: np.ndarray, config: Configuration, monitor: Monitor | None = None
) -> np.ndarray:
    """Subtract the zero offset (node rows, node columns) from depth codes int64 (..., rows, columns), and saturate."""
    return round_saturate(codes - node_map(zero, config), 0, config.depth.width, monitor, "zero_offset")


def exact_zero(depth: np.ndarray, untouched: np.ndarray, config: Configuration) -> np.ndarray:
    """Subtract the zero offset from depth in floating point, without rounding.

    Parameters
    ----------
    depth : array (..., rows, columns), rows in the order of the stream
    untouched : array (..., rows, columns)
        Depth without contact, from which the zero offset is computed.
    """
    log2 = config.reference_block_log2
    sums = block_sum(untouched.reshape(-1, *untouched.shape[-2:]), log2).mean(axis=0)
    return depth - interpolated(sums, config) / (1 << 4 * log2 + 2)


def latency(lanes: int, block_log2: int) -> int:
    """Return the latency: td_node_map and the subtraction."""
    return td_node_map.latency(lanes, block_log2) + 1


class ZeroOffset:
    """Nodes, and the beat that leaves: valid, its position, its depths, and how many of them are clipped."""

    def __init__(self, config: Configuration, entries: Sequence[int | None], lanes: int) -> None:
        self.map = td_node_map.NodeMap(config, entries, TABLES["zero"], 1, lanes, 1)
        self.rows, self._lanes, self._width, self._begun = config.rows, lanes, config.depth.width, 0
        self._beat: tuple[int, int, int | None] = (0, 0, None)
        self._clipped: int | None = 0

    def clock(self, *, capture_zero: int, in_position: int, in_data: int, **pins: int) -> dict[str, int | None]:
        """Advance by one clock edge; return the outputs before it, None where one does not count."""
        bits, (valid, position, depths) = self._lanes * self._width, self._beat
        out = {"out_valid": valid, "out_position": position if valid else None, "out_data": depths}
        out["saturations"] = self._clipped
        start, data = in_position >> 2, in_position << bits | in_data
        capture = {"capture_words": capture_zero, "capture_read": 0, "capture_read_node": 0}
        nodes = self.map.clock(**pins, **capture, in_frame_start=start, in_data=data)
        out |= {name: nodes[name] for name in ("table_answer", "table_in_use")}
        out["active"] = self._begun or nodes["active"] or valid
        self._clipped = 0
        if pins["en"]:
            if pins["in_valid"]:
                self._begun = not in_position & 1
            self._beat = (0, 0, None)
            if nodes["out_valid"]:
                depths, self._clipped = self._zeroed(nodes["out_data"], nodes["out_words"])
                self._beat = (1, nodes["out_data"] >> bits, depths)
        if pins["rst"]:
            self._beat, self._clipped, self._begun = (0, 0, None), 0, 0
        return out

    def _zeroed(self, depths: int, zero: int | None) -> tuple[int | None, int | None]:
        """Return the depths of a beat less the zero offset, and how many of them are clipped."""
        if zero is None:
            return None, None
        sign, out = 1 << self._width - 1, []
        for depth, offset in zip(*(split(word, self._lanes, self._width) for word in (depths, zero)), strict=True):
            out.append((depth ^ sign) - (offset ^ sign))
        saturated = [min(max(depth, -sign), sign - 1) for depth in out]
        return joined(saturated, self._width), sum(map(int.__ne__, out, saturated))


def parts(config: Configuration) -> Parts:
    """Return the tables of nodes, the products by row weights, and the line of depths."""
    log2, data, lanes = config.reference_block_log2, config.depth.width, config.lanes
    side, (rows, columns) = td_node_map.side(lanes, log2), config.reference_nodes
    return [
        Words(lanes * data),
        *banks(data, rows * columns // side) * (side * td_node_map.tables(lanes, log2)),
        *delay_line(lanes * data + DEPTH_MARKS, td_node_map.latency(lanes, log2)),
        *[Multiplier(data + 1, log2 + 2)] * side,
    ]
