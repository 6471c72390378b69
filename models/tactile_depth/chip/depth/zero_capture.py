# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/depth/zero_capture.sv: the zero offset of zero_offset from depth without contact."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common import td_node_map
from tactile_depth.chip.common.td_block_sum import CYCLES_TO_SUM, block_sum
from tactile_depth.chip.common.td_round_saturate import round_half_even
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.resources import BLOCK, Memory, Parts, Words

LARGEST_LOG2 = 8
"""Base-2 logarithm of the most frames in a capture; it equals that of reference_capture."""


def levels(lanes: int, block_log2: int) -> int:
    """Return the levels in which the depths of a beat, or of a block, are added up; each takes a cycle."""
    return min(lanes.bit_length() - 1, block_log2)


def cycles(lanes: int, block_log2: int) -> int:
    """Return the cycles from the last beat of the last row of blocks to `done`."""
    return levels(lanes, block_log2) + CYCLES_TO_SUM + 2


def captured_zero(codes: np.ndarray, config: Configuration) -> np.ndarray:
    """Return the mean of each block over frames, rounded with ties to even.

    Parameters
    ----------
    codes : int64 array (2**k, rows, columns)
        Depth before a zero offset is subtracted.

    Returns
    -------
    int64 array (node rows, node columns)
    """
    count = len(codes)
    assert count.bit_count() == 1, "a power of two of frames"
    log2 = count.bit_length() - 1
    sums = block_sum(codes, config.reference_block_log2).sum(axis=0)
    return round_half_even(sums, 2 * config.reference_block_log2 + log2)


def parts(config: Configuration) -> Parts:
    """Return the sums of nodes that are written at once."""
    log2, (rows, columns) = config.reference_block_log2, config.reference_nodes
    side = td_node_map.side(config.lanes, log2)
    width = side * (config.depth.width + 2 * log2 + LARGEST_LOG2)
    return [Words(config.lanes * config.depth.width), Memory("tables", width, rows * columns // side, BLOCK)]
