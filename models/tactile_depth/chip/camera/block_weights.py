# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/camera/block_weights.sv."""

from __future__ import annotations

from math import ceil

import numpy as np


def pixels_of(blocks: int, numerator: int, denominator: int) -> int:
    """Return the number of pixels that `blocks` blocks of numerator / denominator pixels cover in part at least."""
    return ceil(blocks * numerator / denominator)


def block_weights(pixels: int, numerator: int, denominator: int) -> tuple[np.ndarray, np.ndarray]:
    """Cut an axis of pixels into blocks of numerator / denominator pixels.

    Returns
    -------
    weight : int64 array (pixels,)
        Part of each pixel in the block that it is in, or begins in, in units of 1 / denominator of a pixel.
    block_ends : bool array (pixels,)
        The pixel is the last of that block; its other part is in the next one.
    """
    begin = np.arange(pixels, dtype=np.int64) * denominator
    left = numerator - begin % numerator
    return np.minimum(left, denominator), left <= denominator
