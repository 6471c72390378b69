# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/camera/area_average.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.camera.block_totals import block_areas, block_totals
from tactile_depth.camera.round_divide import round_divide
from tactile_depth.camera.row_sums import red_columns, row_sums

FULL_SCALE = 8
"""Bits of a colour of the grid."""


def area_average(
    samples: np.ndarray, bits: int, numerator: int, denominator: int, colour: tuple[int, int] | None = None
) -> np.ndarray:
    """Return the mean colours of blocks of numerator / denominator pixels, rounded once.

    Parameters
    ----------
    samples : int64 array (rows, columns, 3), or of a Bayer pattern (rows, columns)
        2**bits is full scale.
    colour : (int, int)
        Bayer: is the first row one of blue, is the first column? None for RGB.

    Returns
    -------
    uint8 array (block rows, blocks, 3)
        Blocks that are not complete are left out.
    """
    blue_rows = blue_columns = None
    area: np.ndarray | int = numerator**2
    if colour is not None:
        blue_rows, blue_columns = (
            (np.arange(length) + first) % 2 == 1 for length, first in zip(samples.shape, colour, strict=True)
        )
        area = block_areas(
            red_columns(blue_rows, numerator, denominator), red_columns(blue_columns, numerator, denominator), numerator
        )
    sums = row_sums(samples, blue_columns, numerator, denominator)
    totals = block_totals(sums, blue_rows, numerator, denominator)
    return round_divide(totals, area, bits - FULL_SCALE)
