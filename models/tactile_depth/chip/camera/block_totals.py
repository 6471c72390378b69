# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/camera/block_totals.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.camera.row_sums import sums_over_blocks

LATENCY = 3


def block_totals(sums: np.ndarray, blue_rows: np.ndarray | None, numerator: int, denominator: int) -> np.ndarray:
    """Return the totals of blocks from the sums of rows over blocks of columns.

    Parameters
    ----------
    sums : int64 array (rows, blocks, lanes), of `row_sums`
    blue_rows : bool array (rows,)
        Rows of a Bayer pattern that hold blue; None for RGB.

    Returns
    -------
    int64 array (block rows, blocks, 3)
    """
    colours = sums
    if blue_rows is not None:
        blue = blue_rows[:, None]
        red_columns, blue_columns = sums[..., 0], sums[..., 1]
        green = np.where(blue, red_columns, blue_columns)
        colours = np.stack((np.where(blue, 0, red_columns), green, np.where(blue, blue_columns, 0)), axis=-1)
    return np.moveaxis(sums_over_blocks(np.moveaxis(colours, 0, -1), numerator, denominator), -1, 0)


def block_areas(red_rows: np.ndarray, red_columns: np.ndarray, numerator: int) -> np.ndarray:
    """Return the area of each colour of a Bayer pattern in each block, in units of 1 / denominator^2 of a pixel.

    Parameters
    ----------
    red_rows : int64 array (block rows,)
        Height of the rows of red in each block.
    red_columns : int64 array (blocks,)
        Width of the columns of red in each block.

    Returns
    -------
    int64 array (block rows, blocks, 3)
    """
    red = np.outer(red_rows, red_columns)
    blue = np.outer(numerator - red_rows, numerator - red_columns)
    return np.stack((red, numerator**2 - red - blue, blue), axis=-1)
