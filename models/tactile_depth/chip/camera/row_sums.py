# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/camera/row_sums.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.camera.block_weights import block_weights

LATENCY = 3


def sums_over_blocks(values: np.ndarray, numerator: int, denominator: int) -> np.ndarray:
    """Return weighted sums of integers over blocks of numerator / denominator values along the last axis.

    Parameters
    ----------
    values : int64 array (..., pixels)

    Returns
    -------
    int64 array (..., blocks)
        A block that is not complete is left out.
    """
    weight, block_ends = block_weights(values.shape[-1], numerator, denominator)
    covered = np.cumsum(values, axis=-1) * denominator
    until = (covered - (denominator - weight) * values)[..., block_ends]
    return np.diff(until, axis=-1, prepend=0)


def row_sums(samples: np.ndarray, blue_columns: np.ndarray | None, numerator: int, denominator: int) -> np.ndarray:
    """Return the sums of camera rows over blocks of columns.

    Parameters
    ----------
    samples : int64 array (rows, columns, 3), or of a Bayer pattern (rows, columns)
    blue_columns : bool array (columns,)
        Columns of a Bayer pattern that hold blue; None for RGB.

    Returns
    -------
    int64 array (rows, blocks, lanes)
        RGB: the colours. Bayer: columns of red, columns of blue.
    """
    if blue_columns is None:
        lanes = np.moveaxis(samples, -1, 0)
    else:
        lanes = np.stack((np.where(blue_columns, 0, samples), np.where(blue_columns, samples, 0)))
    return np.moveaxis(sums_over_blocks(lanes, numerator, denominator), 0, -1)


def red_columns(blue_columns: np.ndarray, numerator: int, denominator: int) -> np.ndarray:
    """Return the width of the columns of red in each block, in units of 1 / denominator of a pixel, int64 (blocks,)."""
    return sums_over_blocks((~blue_columns).astype(np.int64), numerator, denominator)
