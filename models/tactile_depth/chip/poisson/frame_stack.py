# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/frame_stack.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.resources import Memory, Parts, Words

LATENCY = 3  # from the first word of the last row


def frame_stack(rows: np.ndarray) -> np.ndarray:
    """Return the rows of frames (..., rows, columns) in reverse order, last row first."""
    return rows[..., ::-1, :]


def parts(config: Configuration) -> Parts:
    data, packed = config.depth.width, config.words_per_row
    words = config.rows * -(-config.columns // packed)
    return [Words(data), Memory("frame stores", data * packed, words, config.store_style)]
