# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/divergence.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.resources import Memory, Parts, Words, late_style

LATENCY = 2


def divergence(gradient: np.ndarray, neumann: bool = False) -> np.ndarray:
    """Return the backward differences gx[i,j] - gx[i,j-1] + gy[i,j] - gy[i-1,j], exact, with zero outside the frame.

    Neumann: gx of the last column and gy of the last row, the slopes across the edge, count as 0.
    The depth map is shifted by half a pixel up and to the left, because slopes are differenced backwards.

    Parameters
    ----------
    gradient : array (..., rows, cols, 2), gx and gy

    Returns
    -------
    array (..., rows, cols) of the same type
    """
    gx, gy = np.array(gradient[..., 0]), np.array(gradient[..., 1])
    if neumann:
        gx[..., -1] = 0
        gy[..., -1, :] = 0
    f = np.empty_like(gx)
    f[..., 0] = gx[..., 0]
    np.subtract(gx[..., 1:], gx[..., :-1], out=f[..., 1:])
    f[..., 0, :] += gy[..., 0, :]
    f[..., 1:, :] += gy[..., 1:, :] - gy[..., :-1, :]
    return f


def parts(config: Configuration) -> Parts:
    """Return the buffer of the row above."""
    slope = config.gradient.width
    return [Words(slope), Memory("row buffers", slope, config.columns, late_style(slope * config.columns))]
