# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/corner_turn.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.transform.orders import natural
from tactile_depth.chip.resources import Memory, Parts, Words


def corner_turn(rows: np.ndarray) -> np.ndarray:
    """Return rows (..., N) in Makhoul order in natural order."""
    return rows[..., natural(rows.shape[-1])]


def latency(size: int, paths: int) -> int:
    """Return the cycles from a start to the first words of the first row; starts come 2 cycles before their words."""
    return size // paths + 4


def parts(config: Configuration) -> Parts:
    """Return two bursts of memory for each word of a beat and half of the positions."""
    paths, data = config.up_paths, config.depth.width
    beats = config.columns // paths
    turned = Memory("row buffers", data, beats if paths == 1 else 2 * beats)
    return [Words(2 * paths * data, work=1 / (2 * paths)), *[turned] * (4 if paths == 1 else 2 * paths)]
