# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/transpose.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.transform.corner_turn import corner_turn
from tactile_depth.chip.poisson.transform.row_order import row_order
from tactile_depth.chip.resources import Memory, Parts, Words

LATENCY = 3  # from the first word of the last row


def transpose(frames: np.ndarray, makhoul_in: bool, makhoul_out: bool) -> np.ndarray:
    """Return the columns of frames (..., N, N); rows in and columns out are in Makhoul or in natural order."""
    natural = corner_turn(frames) if makhoul_in else frames
    columns = natural.swapaxes(-1, -2)
    return row_order(columns) if makhoul_out else columns


def parts(config: Configuration) -> Parts:
    """Return the two frame stores."""
    data = config.depth.width
    return [Words(data), Memory("frame stores", data, config.columns**2, config.store_style)] * 2
