# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/common/td_node_map.sv: words of every pixel from those of a coarse grid of nodes.

Interpolation, along rows and columns alike: with blocks of b = 2**L pixels, pixel i lies at pos = 2 i + 1 - b half
pixels from the first block's centre, clamped to the first and the last centre (constant beyond them);
node = pos >> (L + 1), w = pos mod 2 b, and 2 b times the word is (2 b - w) F[node] + w F[node + 1]. Both directions
are exact; one rounding to even, of 2 L + 2 bits, makes the word. Where w is 0 the next node has no effect. The words do
not depend on the lanes.
"""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common import td_ramp
from tactile_depth.chip.common.td_round_saturate import round_half_even
from tactile_depth.chip.configuration import Configuration

CYCLES_TO_RAMP = 9
"""Cycles from a beat to the first word of its ramps."""


def side(lanes: int, block_log2: int) -> int:
    """Return the nodes that lie side by side in a word of the table, and that the capture writes at once."""
    return max(1, lanes >> block_log2)


def tables(lanes: int, block_log2: int) -> int:
    """Return the tables of a word of the nodes: with a beat of a block or more one for those above, one for those
    below."""
    return 1 if lanes < 1 << block_log2 else 2


def latency(lanes: int, block_log2: int) -> int:
    """Return the latency in cycles: to the ramps of half a block each, or of a beat; the ramps; the rounding."""
    return CYCLES_TO_RAMP + td_ramp.latency(min(lanes, 1 << block_log2 - 1)) + 1


def entries_per_node(channels: int) -> int:
    """Return the entries of the table for each node: a power of two."""
    return 1 << (channels - 1).bit_length()


def table_entries(nodes: np.ndarray) -> dict[int, int]:
    """Return the table entries, index to word, that the bus writes for nodes (node rows, node columns, channels)."""
    words = np.asarray(nodes).reshape(-1, np.shape(nodes)[-1])
    step = entries_per_node(words.shape[-1])
    return {step * node + channel: word for node, of in enumerate(words.tolist()) for channel, word in enumerate(of)}


def node_map(nodes: np.ndarray, config: Configuration) -> np.ndarray:
    """Return the words of every pixel, int64 (rows, columns, ..), from words at nodes (node rows, node columns, ..)."""
    return round_half_even(interpolated(nodes, config), 2 * config.reference_block_log2 + 2)


def interpolated(nodes: np.ndarray, config: Configuration) -> np.ndarray:
    """Interpolate words at nodes (node rows, node columns, ..) to the pixels (rows, columns, ..), times 4 b**2."""
    log2 = config.reference_block_log2
    down = _interpolated(nodes, config.rows, log2)
    return _interpolated(down.swapaxes(0, 1), config.columns, log2).swapaxes(0, 1)


def _interpolated(nodes: np.ndarray, pixels: int, log2: int) -> np.ndarray:
    """Interpolate between nodes along axis 0; the result is scaled by twice the block size."""
    at = np.clip(2 * np.arange(pixels) + 1 - (1 << log2), 0, (len(nodes) - 1) << (log2 + 1))
    node, weight = at >> (log2 + 1), (at & ((2 << log2) - 1)).reshape(-1, *[1] * (nodes.ndim - 1))
    return nodes[node] * ((2 << log2) - weight) + nodes[np.minimum(node + 1, len(nodes) - 1)] * weight
