# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/common/td_dot_product.sv: two products and their sum."""

from __future__ import annotations

import numpy as np

LATENCY = 4


def dot_product(a0: np.ndarray, b0: np.ndarray, a1: np.ndarray, b1: np.ndarray) -> np.ndarray:
    """Return a0 b0 + a1 b1 of int64 arrays, exact up to 62 bits of both factors together."""
    return a0 * b0 + a1 * b1
