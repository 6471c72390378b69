# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/common/td_multiply.sv: one product."""

from __future__ import annotations

import numpy as np

LATENCY = 1


def multiply(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return a b of int64 arrays, exact up to 63 bits of both factors together."""
    return a * b
