# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/camera/black_level.sv."""

from __future__ import annotations

import numpy as np

LATENCY = 1


def black_level(samples: np.ndarray, level: int) -> np.ndarray:
    """Return the samples, int64, less the black level."""
    return samples - level
