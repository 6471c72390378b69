# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/camera/area_average.sv."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tactile_depth.chip.camera.block_totals import LATENCY as BLOCK_TOTALS
from tactile_depth.chip.camera.block_totals import block_areas, block_totals
from tactile_depth.chip.camera.round_divide import LATENCY as ROUND_DIVIDE
from tactile_depth.chip.camera.round_divide import round_divide
from tactile_depth.chip.camera.row_sums import LATENCY as ROW_SUMS
from tactile_depth.chip.camera.row_sums import red_columns, row_sums
from tactile_depth.chip.camera_configuration import GAIN

GAINS = 2  # cycles
LATENCY = ROW_SUMS + BLOCK_TOTALS + GAINS + ROUND_DIVIDE

FULL_SCALE = 8
"""Bits of a colour of the grid."""
UNITY = (1 << GAIN.fraction,) * 3
"""Codes of gains of 1."""


def area_average(
    samples: np.ndarray,
    bits: int,
    numerator: int,
    denominator: int,
    colour: tuple[int, int] | None = None,
    gains: Sequence[int] = UNITY,
) -> np.ndarray:
    """Return the mean colours of blocks of numerator / denominator pixels times their gains, rounded once.

    Parameters
    ----------
    samples : int64 array (rows, columns, 3), or of a Bayer pattern (rows, columns)
        2**bits is full scale.
    colour : (int, int)
        Bayer: is the first row one of blue, is the first column? None for RGB.
    gains : three int
        Of red, green and blue, in units of 2**-12.

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
    return round_divide(totals * np.array(gains, np.int64), area, bits - FULL_SCALE + GAIN.fraction)
