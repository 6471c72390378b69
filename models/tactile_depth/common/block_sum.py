# SPDX-License-Identifier: Apache-2.0
"""Model of hdl/common/block_sum.sv, frame by frame."""

from __future__ import annotations

import numpy as np

CYCLES_TO_SUM = 4
"""Cycles from the last word of a block's row to the write of its sum."""


def block_sum(frames: np.ndarray, block_log2: int) -> np.ndarray:
    """Return the sum of each whole block of 2**block_log2 by 2**block_log2 words.

    Parameters
    ----------
    frames : int array (frames, rows, columns, ...)

    Returns
    -------
    int array (frames, block rows, block columns, ...)
    """
    count, rows, columns, *channels = frames.shape
    block = 1 << block_log2
    whole = frames[:, : rows // block * block, : columns // block * block]
    return whole.reshape(count, rows // block, block, columns // block, block, *channels).sum(axis=(2, 4))
