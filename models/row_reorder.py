# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/row_reorder.sv."""

from __future__ import annotations

import numpy as np

from models.orders import makhoul


def row_reorder(rows: np.ndarray, to_burst: bool) -> np.ndarray:
    """Rows (..., N) from natural to Makhoul order, or back."""
    order = makhoul(rows.shape[-1])
    return rows[..., order if to_burst else np.argsort(order)]
