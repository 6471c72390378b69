# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/frame_stack.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.resources import DISTRIBUTED, Memory, Parts, Words

LEAD = 6  # clocks from a start to the first words


def latency(columns: int, in_words: int, paths: int) -> int:
    """Return the clocks from the first words of the last row in to its first words out."""
    return 1 if in_words == paths else columns // in_words - columns // paths + 4


def frame_stack(rows: np.ndarray) -> np.ndarray:
    """Return the rows of frames (..., rows, columns) in reverse order, last row first."""
    return rows[..., ::-1, :]


def parts(config: Configuration) -> Parts:
    paths, data, words = config.up_paths, config.depth.width, config.words_per_row
    row = Memory("row buffers", words * data, config.columns // paths, DISTRIBUTED)
    burst = -(-config.columns // words)
    slots = ((config.rows - 1) // 2, (config.rows - 2) // 2)  # lower and upper rows of pairs
    stores = [Memory("frame stores", words * data, count * burst, config.store_style) for count in slots]
    return [Words(2 * paths * data, work=1 / (2 * paths)), *[row] * (2 if config.down_words < paths else 0), *stores]
