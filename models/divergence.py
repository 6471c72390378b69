# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/divergence.sv."""

from __future__ import annotations

import numpy as np


def divergence(gradient: np.ndarray) -> np.ndarray:
    """Backward differences gx[i,j] - gx[i,j-1] + gy[i,j] - gy[i-1,j], exact, with zero outside the frame.

    A gradient belongs to its pixel's centre, so this places the depth half a pixel up and left.

    Parameters
    ----------
    gradient : array (..., rows, cols, 2), gx and gy

    Returns
    -------
    array (..., rows, cols) of the same type
    """
    gx, gy = gradient[..., 0], gradient[..., 1]
    return np.diff(gx, axis=-1, prepend=0) + np.diff(gy, axis=-2, prepend=0)
