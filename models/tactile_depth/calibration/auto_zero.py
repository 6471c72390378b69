# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/calibration/auto_zero.sv: depth minus the floor.

The floor is the depth that a pixel reads without contact. Lights and gel drift, and the remaining slope errors add up
to a floor that is not flat. The floor is smooth, so a coarse grid of block means holds it: the grid of the reference
frame (flat_field.py). The means are interpolated between the centres of the blocks by the same hardware. Codes are
depth codes. Rows are in the order of the stream, and nodes run row by row in the same order.
"""

from __future__ import annotations

import numpy as np

from tactile_depth.calibration.flat_field import interpolate_nodes
from tactile_depth.common.block_sum import block_sum
from tactile_depth.common.round_saturate import Monitor, round_half_even, round_saturate
from tactile_depth.configuration import Configuration


def auto_zero_parameters(config: Configuration) -> dict[str, int]:
    """Parameters of hdl/calibration/auto_zero.sv."""
    return {
        "Rows": config.rows,
        "Columns": config.columns,
        "BlockLog2": config.reference_block_log2,
        "Width": config.depth.width,
        "Lanes": config.lanes,
    }


def no_floor(config: Configuration) -> np.ndarray:
    """Return the floor at power-up of a build without an initial floor: int64 zeros (node rows, node columns)."""
    return np.zeros(config.reference_nodes, np.int64)


def interpolated_floor(floor: np.ndarray, config: Configuration) -> np.ndarray:
    """Return the floor at every pixel, int64 (rows, columns), from codes at the nodes (node rows, node columns)."""
    return round_half_even(interpolate_nodes(floor[..., None], config)[..., 0], 2 * config.reference_block_log2 + 2)


def auto_zero(
    codes: np.ndarray, floor: np.ndarray, config: Configuration, monitor: Monitor | None = None
) -> np.ndarray:
    """Subtract the floor (node rows, node columns) from depth codes int64 (..., rows, columns), and saturate."""
    return round_saturate(codes - interpolated_floor(floor, config), 0, config.depth.width, monitor, "auto_zero")


def exact_zero(depth: np.ndarray, untouched: np.ndarray, config: Configuration) -> np.ndarray:
    """Subtract the floor from depth in floating point, without rounding.

    Parameters
    ----------
    depth : array (..., rows, columns), rows in the order of the stream
    untouched : array (..., rows, columns)
        Depth without contact, from which the floor is computed.
    """
    log2 = config.reference_block_log2
    sums = block_sum(untouched.reshape(-1, *untouched.shape[-2:]), log2).mean(axis=0)
    return depth - interpolate_nodes(sums[..., None], config)[..., 0] / (1 << 4 * log2 + 2)
