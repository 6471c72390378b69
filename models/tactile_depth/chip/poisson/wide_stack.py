# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/wide_stack.sv, and the order of modes in the wide solver."""

from __future__ import annotations

from functools import cache

import numpy as np

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.transform.orders import read_only
from tactile_depth.chip.poisson.transform.wide_row_pairs import up_positions
from tactile_depth.chip.resources import DISTRIBUTED, Memory, Parts, Words

LEAD = 6  # clocks from a start to the first words


def latency(columns: int, in_words: int, out_words: int) -> int:
    """Return the clocks from the first words of the last row in to its first words out."""
    return columns // in_words - columns // out_words // 2 + 2


@cache
def down_positions(columns: int, words: int) -> np.ndarray:
    """Return the positions of each clock on the way down, int64 (clocks, words)."""
    return read_only(np.arange(columns).reshape(-1, words))


def wide_stack(rows: np.ndarray, words: int) -> np.ndarray:
    """Return the beats (..., rows, beats, words) of rows (..., rows, columns), last row first."""
    return rows[..., ::-1, :][..., up_positions(rows.shape[-1], words)]


def parts(config: Configuration) -> Parts:
    lanes, data = config.lanes, config.depth.width
    group, beats = min(config.down_words, lanes // 2), config.columns // lanes  # words in a memory
    row = Memory("row buffers", group * data, beats, DISTRIBUTED)
    store = Memory("frame stores", group * data, (config.rows - 1) * beats, config.store_style)
    return [Words(lanes * data), *[row, store] * (lanes // group)]
