# SPDX-License-Identifier: Apache-2.0
"""Latency and nodes of hdl/common/td_node_map.sv; its model is `zero_offset.interpolated_zero`.

With several depths per clock the zero offset is interpolated for neighbouring pixels at once. The words are those of
one depth per clock, code by code.
"""

from __future__ import annotations

from tactile_depth.common import td_ramp

CYCLES_TO_RAMP = 9
"""Cycles from a beat to the first word of its ramps."""


def side(lanes: int, block_log2: int) -> int:
    """Return the nodes that lie side by side in a word of the table, and that the capture writes at once."""
    return max(1, lanes >> block_log2)


def latency(lanes: int, block_log2: int) -> int:
    """Return the latency in cycles: to the ramps of half a block each, or of a beat; the ramps; the rounding."""
    return CYCLES_TO_RAMP + td_ramp.latency(min(lanes, 1 << block_log2 - 1)) + 1
