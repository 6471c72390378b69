# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/row_pairs.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor, round_saturate
from tactile_depth.chip.poisson.transform.orders import mirror


def mode_pairs(modes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return mode k and mode N - k at each position of bursts (..., N) in bit-reversed order; mode N is 0."""
    mirrored = modes[..., mirror(modes.shape[-1])].copy()
    mirrored[..., 0] = 0
    return modes, mirrored


def row_pairs(
    a: np.ndarray, b: np.ndarray, width: int, monitor: Monitor | None = None, node: str = "pair"
) -> tuple[np.ndarray, np.ndarray]:
    """Return C[N-k] + j C[k] of rows C = a + j b (..., N) in bit-reversed order, saturated to `width` bits.

    Real part a[N-k] - b[k], imaginary part a[k] + b[N-k], int64 arrays (..., N); mode N is 0.
    """
    (a, a_mirrored), (b, b_mirrored) = mode_pairs(a), mode_pairs(b)
    re = round_saturate(a_mirrored - b, 0, width, monitor, node + ".re")
    im = round_saturate(a + b_mirrored, 0, width, monitor, node + ".im")
    return re, im


def latency(size: int, paths: int) -> int:
    """Return the latency: half a burst, the memory read, the sum, its register."""
    return size // paths // 2 + 3
