# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/transpose.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.transform.row_reorder import row_reorder
from tactile_depth.chip.resources import Memory, Parts, Words

LATENCY = 2  # from the first word of the last row


def transpose(frames: np.ndarray, makhoul_in: bool, makhoul_out: bool) -> np.ndarray:
    """Return the columns of frames (..., N, N); rows in and columns out are in Makhoul or in natural order."""
    natural = row_reorder(frames, to_burst=False) if makhoul_in else frames
    columns = natural.swapaxes(-1, -2)
    return row_reorder(columns, to_burst=True) if makhoul_out else columns


def parts(config: Configuration) -> Parts:
    """Return the two frame stores."""
    data = config.depth.width
    return [Words(data), Memory("frame stores", data, config.columns**2, config.store_style)] * 2
