# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/row_reorder.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.transform.orders import makhoul, natural
from tactile_depth.chip.resources import Memory, Parts, Words

LATENCY = 2  # from the last word of a row


def row_reorder(rows: np.ndarray, to_burst: bool) -> np.ndarray:
    """Reorder rows (..., N) from natural to Makhoul order, or back."""
    order = makhoul if to_burst else natural
    return rows[..., order(rows.shape[-1])]


def parts(config: Configuration) -> Parts:
    """Return the buffers of divergence and of depth."""
    widths = config.divergence.width, config.depth.width
    return [
        *[Words(config.depth.width)] * 2,
        *(Memory("row buffers", width, 2 * config.columns) for width in widths),
    ]
