# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/row_reorder.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.poisson.transform.orders import makhoul, natural

LATENCY = 2  # from the last word of a row


def row_reorder(rows: np.ndarray, to_burst: bool) -> np.ndarray:
    """Reorder rows (..., N) from natural to Makhoul order, or back."""
    order = makhoul if to_burst else natural
    return rows[..., order(rows.shape[-1])]
