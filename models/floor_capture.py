# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/floor_capture.sv: the floor of auto_zero from frames of depth without contact."""

from __future__ import annotations

import numpy as np

from models.auto_zero import auto_zero_parameters, block_sums
from models.configuration import Configuration
from models.round_saturate import round_half_even

LARGEST_LOG2 = 8
"""Of the frames of a capture: that of the reference, so that both registers read alike."""
CLOCKS = 6
"""From the last word of the last row of blocks to `done`."""


def floor_capture_parameters(config: Configuration) -> dict[str, int]:
    """Parameters of hdl/floor_capture.sv."""
    return {**auto_zero_parameters(config), "MaxLog2": LARGEST_LOG2}


def captured_floor(codes: np.ndarray, config: Configuration) -> np.ndarray:
    """Mean of each block over frames, ties to even.

    Parameters
    ----------
    codes : int64 array (2**k, rows, columns)
        Depth before a floor is taken off.

    Returns
    -------
    int64 array (node rows, node columns)
    """
    count = len(codes)
    assert count.bit_count() == 1, "a power of two of frames"
    log2 = count.bit_length() - 1
    return round_half_even(block_sums(codes, config).sum(axis=0), 2 * config.reference_block_log2 + log2)
