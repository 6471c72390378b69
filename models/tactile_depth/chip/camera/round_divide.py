# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/camera/round_divide.sv."""

from __future__ import annotations

import numpy as np

LATENCY = 10

WHITE = 255


def round_divide(total: np.ndarray, weight: np.ndarray | int, drop: int) -> np.ndarray:
    """Return total / (weight 2**drop), rounded half to even and clipped to 0..255.

    Parameters
    ----------
    total : int64 array
    weight : positive int64 array that broadcasts against `total`

    Returns
    -------
    uint8 array
    """
    divisor = np.asarray(weight, np.int64) << drop
    quotient, remainder = np.divmod(total, divisor)
    twice = 2 * remainder
    up = (twice > divisor) | ((twice == divisor) & (quotient & 1 == 1))
    return np.clip(quotient + up, 0, WHITE).astype(np.uint8)
