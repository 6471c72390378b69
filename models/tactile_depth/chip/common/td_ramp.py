# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/common/td_ramp.sv: words an equal step apart."""

from __future__ import annotations

import numpy as np


def latency(count: int) -> int:
    """Return the latency in cycles of a ramp of `count` words, a power of two: the levels of its tree."""
    return count.bit_length() - 1


def ramp(first: np.ndarray, step: np.ndarray, count: int, width: int) -> np.ndarray:
    """Return first + n step, n = 0 .. count - 1, modulo 2**width: int64 (..., count) of int64 arrays (...)."""
    words = first[..., None] + np.arange(count) * step[..., None]
    return words & (1 << width) - 1
