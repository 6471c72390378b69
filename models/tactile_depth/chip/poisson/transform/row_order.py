# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/row_order.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.transform.orders import makhoul
from tactile_depth.chip.resources import Memory, Parts, Words

LATENCY = 0  # cycles from the last word of a row to its start


def row_order(rows: np.ndarray) -> np.ndarray:
    """Return rows (..., N) in natural order in Makhoul order."""
    return rows[..., makhoul(rows.shape[-1])]


def parts(config: Configuration) -> Parts:
    down = config.down_words
    return [
        Words(down * config.depth.width),
        *[Memory("row buffers", config.divergence.width, 2 * config.columns // down)] * down,
    ]
