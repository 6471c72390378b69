# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/transpose.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.poisson.transform.row_reorder import row_reorder

LATENCY = 2  # from the first word of the last row


def transpose(frames: np.ndarray, makhoul_in: bool, makhoul_out: bool) -> np.ndarray:
    """Return the columns of frames (..., N, N); rows in and columns out are in Makhoul or in natural order."""
    natural = row_reorder(frames, to_burst=False) if makhoul_in else frames
    columns = natural.swapaxes(-1, -2)
    return row_reorder(columns, to_burst=True) if makhoul_out else columns
