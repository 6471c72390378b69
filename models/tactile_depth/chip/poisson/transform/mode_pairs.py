# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/mode_pairs.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.poisson.transform.orders import mirror


def mode_pairs(modes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return mode k and mode N - k at each position of bursts (..., N) in bit-reversed order; mode N is 0."""
    mirrored = modes[..., mirror(modes.shape[-1])].copy()
    mirrored[..., 0] = 0
    return modes, mirrored


def latency(size: int) -> int:
    """Return the latency: half a burst, the position of the mirrored mode, and the memory read."""
    return size // 2 + 2
