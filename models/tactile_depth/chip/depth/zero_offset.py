# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/depth/zero_offset.sv: depth minus the zero offset.

The zero offset is the depth that a pixel reads without contact. Lights and gel drift, and the remaining slope errors
add up to a zero offset that is not flat. It is smooth, so a coarse grid of block means holds it: the grid of the
reference frame (flat_field.py). The means are interpolated between the centres of the blocks (td_node_map). Codes are
depth codes. Rows are in the order of the stream, and nodes run row by row in the same order.
"""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common import td_node_map
from tactile_depth.chip.common.td_block_sum import block_sum
from tactile_depth.chip.common.td_node_map import interpolated, node_map
from tactile_depth.chip.common.td_round_saturate import Monitor, round_saturate
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.resources import DEPTH_MARKS, Memory, Multiplier, Parts, Words, banks


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


def parts(config: Configuration) -> Parts:
    """Return the tables of nodes, the products by row weights, and the line of depths."""
    log2, data, lanes = config.reference_block_log2, config.depth.width, config.lanes
    side, (rows, columns) = td_node_map.side(lanes, log2), config.reference_nodes
    return [
        Words(lanes * data),
        *banks(data, rows * columns // side) * (side * td_node_map.tables(lanes, log2)),
        Memory("delay lines", lanes * data + DEPTH_MARKS, td_node_map.latency(lanes, log2)),
        *[Multiplier(data + 1, log2 + 2)] * side,
    ]
