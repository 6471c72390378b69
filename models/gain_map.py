# SPDX-License-Identifier: Apache-2.0
"""Parameters of hdl/gain_map.sv and its entries; its model is `models.flat_field.interpolated_gains`."""

from __future__ import annotations

import numpy as np

from models.configuration import GAIN_WIDTH, Configuration

ENTRIES_PER_NODE = 4  # red, green, blue, and one that is not used


def gain_map_parameters(config: Configuration) -> dict[str, int]:
    """Parameters of hdl/gain_map.sv."""
    return {
        "Rows": config.rows,
        "Columns": config.columns,
        "BlockLog2": config.reference_block_log2,
        "Width": GAIN_WIDTH,
    }


def table_entries(gains: np.ndarray) -> dict[int, int]:
    """What the bus writes for gains (node rows, node columns, 3): index of the entry to word."""
    nodes = np.asarray(gains).reshape(-1, 3).tolist()
    return {
        ENTRIES_PER_NODE * node + channel: word for node, gain in enumerate(nodes) for channel, word in enumerate(gain)
    }
