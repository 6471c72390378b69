# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/corner_turn.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.poisson.transform.row_reorder import row_reorder

LATENCY = 3  # from the last word of a row


def corner_turn(rows: np.ndarray, lanes: int) -> np.ndarray:
    """Return rows (..., N) in Makhoul order as clocks (..., N / lanes, lanes) of words in natural order."""
    words = row_reorder(rows, to_burst=False)
    return words.reshape(*words.shape[:-1], -1, lanes)
