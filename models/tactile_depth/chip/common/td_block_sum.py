# SPDX-License-Identifier: Apache-2.0
"""Model of hdl/common/td_block_sum.sv, frame by frame."""

from __future__ import annotations

import numpy as np

CYCLES_TO_SUM = 5
"""Cycles from the last word of a block's row to the write of its sum."""


def block_sum(frames: np.ndarray, block_log2: int, column_log2: int | None = None) -> np.ndarray:
    """Return the sum of each whole block of 2**block_log2 rows by 2**column_log2 words, by default as many.

    Parameters
    ----------
    frames : int array (frames, rows, columns, ...)

    Returns
    -------
    int array (frames, block rows, block columns, ...)
    """
    count, rows, columns, *channels = frames.shape
    block = 1 << block_log2
    wide = block if column_log2 is None else 1 << column_log2
    whole = frames[:, : rows // block * block, : columns // wide * wide]
    return whole.reshape(count, rows // block, block, columns // wide, wide, *channels).sum(axis=(2, 4))
