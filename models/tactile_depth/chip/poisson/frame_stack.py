# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/frame_stack.sv."""

from __future__ import annotations

import numpy as np

LATENCY = 3  # from the first word of the last row


def frame_stack(rows: np.ndarray) -> np.ndarray:
    """Return the rows of frames (..., rows, columns) in reverse order, last row first."""
    return rows[..., ::-1, :]
