# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/divergence.sv."""

from __future__ import annotations

import numpy as np


def divergence(gradient: np.ndarray, neumann: bool = False) -> np.ndarray:
    """Backward differences gx[i,j] - gx[i,j-1] + gy[i,j] - gy[i-1,j], exact, with zero outside the frame.

    Neumann: gx of the last column and gy of the last row count as 0, the slope across the edge.
    A gradient belongs to its pixel's centre, so this places the depth half a pixel up and left.

    Parameters
    ----------
    gradient : array (..., rows, cols, 2), gx and gy

    Returns
    -------
    array (..., rows, cols) of the same type
    """
    gx, gy = gradient[..., 0], gradient[..., 1]
    if neumann:
        gx, gy = gx.copy(), gy.copy()
        gx[..., -1] = 0
        gy[..., -1, :] = 0
    return np.diff(gx, axis=-1, prepend=0) + np.diff(gy, axis=-2, prepend=0)
