# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/auto_zero.sv: depth less the floor, what depth reads at its place where nothing touches.

Lights and gel drift, and what is left of that in the slopes adds up to a floor that is not flat. It is as smooth as
what makes it, so a coarse grid of block means holds it, that of the reference frame (models/flat_field.py); they are
interpolated between the blocks' centres by the same hardware. Codes are those of depth. Rows are in the order of the
stream, nodes row by row in the same order.
"""

from __future__ import annotations

import numpy as np

from models.configuration import Configuration
from models.flat_field import interpolate_nodes
from models.round_saturate import Monitor, round_half_even, round_saturate


def auto_zero_parameters(config: Configuration) -> dict[str, int]:
    """Parameters of hdl/auto_zero.sv."""
    return {
        "Rows": config.rows,
        "Columns": config.columns,
        "BlockLog2": config.reference_block_log2,
        "Width": config.depth.width,
    }


def no_floor(config: Configuration) -> np.ndarray:
    """The floor at power-up, of a build that is given none: int64 zeros (node rows, node columns)."""
    return np.zeros(config.reference_nodes, np.int64)


def interpolated_floor(floor: np.ndarray, config: Configuration) -> np.ndarray:
    """What is subtracted at every place: int64 (rows, columns) of codes (node rows, node columns)."""
    return round_half_even(interpolate_nodes(floor[..., None], config)[..., 0], 2 * config.reference_block_log2 + 2)


def auto_zero(
    codes: np.ndarray, floor: np.ndarray, config: Configuration, monitor: Monitor | None = None
) -> np.ndarray:
    """Depth codes int64 (..., rows, columns) less the floor (node rows, node columns), saturated."""
    return round_saturate(codes - interpolated_floor(floor, config), 0, config.depth.width, monitor, "auto_zero")


def exact_zero(depth: np.ndarray, untouched: np.ndarray, config: Configuration) -> np.ndarray:
    """The same in floating point, unrounded: depth (..., rows, columns) less the floor that `untouched` (..., rows,
    columns) shows; rows in the order of the stream, as blocks are counted."""
    log2 = config.reference_block_log2
    return depth - interpolate_nodes(block_sums(untouched, config).mean(axis=0)[..., None], config)[..., 0] / (
        1 << 4 * log2 + 2
    )


def block_sums(depths: np.ndarray, config: Configuration) -> np.ndarray:
    """Sums over each block: (frames, node rows, node columns) of (..., rows, columns)."""
    block = 1 << config.reference_block_log2
    rows, columns = config.reference_nodes
    whole = depths.reshape(-1, *depths.shape[-2:])[:, : rows * block, : columns * block]
    return whole.reshape(-1, rows, block, columns, block).sum(axis=(2, 4))
