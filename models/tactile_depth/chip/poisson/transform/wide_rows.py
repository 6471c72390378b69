# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/wide_rows.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.transform.orders import makhoul
from tactile_depth.chip.poisson.transform.wide_commutator import to_beats
from tactile_depth.chip.resources import Memory, Parts, Words

LATENCY = 0  # cycles from the last word of a row to its start


def wide_rows(rows: np.ndarray, paths: int) -> np.ndarray:
    """Return rows (..., N) in natural order as beats (..., N / paths, paths) in the order of wide_dst_forward."""
    size = rows.shape[-1]
    return to_beats(rows[..., makhoul(size)], paths, (size // paths).bit_length() - 1)


def parts(config: Configuration) -> Parts:
    down = config.down_words
    return [
        Words(down * config.depth.width),
        *[Memory("row buffers", config.divergence.width, 2 * config.columns // down)] * down,
    ]
