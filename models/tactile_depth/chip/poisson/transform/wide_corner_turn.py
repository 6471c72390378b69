# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/wide_corner_turn.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.poisson.transform.orders import natural


def wide_corner_turn(rows: np.ndarray, paths: int) -> np.ndarray:
    """Return rows (..., N) in Makhoul order as beats (..., N / (2 paths), 2 paths) in natural order."""
    size = rows.shape[-1]
    return rows[..., natural(size)].reshape(*rows.shape[:-1], -1, 2 * paths)


def latency(size: int, paths: int) -> int:
    """Return the cycles from a start to the first words of the first row; starts come 2 cycles before their words."""
    return size // paths + 4
