# SPDX-License-Identifier: Apache-2.0
"""Entries of hdl/common/td_gain_map.sv; its model is `tactile_depth.gradient.flat_field.interpolated_gains`."""

from __future__ import annotations

import numpy as np

ENTRIES_PER_NODE = 4  # red, green, blue, and one unused entry


def table_entries(gains: np.ndarray) -> dict[int, int]:
    """Return the table entries, index to word, that the bus writes for gains (node rows, node columns, channels)."""
    nodes = np.asarray(gains).reshape(-1, np.shape(gains)[-1]).tolist()
    return {
        ENTRIES_PER_NODE * node + channel: word for node, gain in enumerate(nodes) for channel, word in enumerate(gain)
    }
