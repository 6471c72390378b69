# SPDX-License-Identifier: Apache-2.0
"""Responses to slopes, and the largest depth that slopes can reach."""

from itertools import product

import numpy as np

from tactile_depth.depth import reference


def steps(response: np.ndarray, neumann: bool, axis: int = 0) -> np.ndarray:
    """Return the response to slopes along an axis, from the response to the divergence.

    A slope enters the divergence of its own sample with + and of the next sample with -.

    Neumann: the slope of the last sample counts as 0.
    """
    change = -np.diff(response, axis=axis, append=0)
    if neumann:
        np.moveaxis(change, axis, 0)[-1] = 0
    return change


def slope_response(response: np.ndarray, neumann: bool) -> np.ndarray:
    """Return the response to slopes (rows, columns, 2), from the response to the divergence (rows, columns)."""
    return np.stack((steps(response, neumann, 1), steps(response, neumann, 0)), axis=-1)


def places(rows: int) -> list[int]:
    """Return rows of which one holds the deepest point that slopes can reach: the middle (Dirichlet), an end (Neumann).

    This was found by a search over all positions on small grids, which a test repeats.
    """
    return sorted({0, rows // 2 - 1, rows // 2, rows - 1})


def deepest(rows: int, columns: int, neumann: bool) -> float:
    """Return the largest depth that slopes up to 1 can reach on a grid, in pixels, in exact arithmetic."""
    most = 0.0
    for row, column in product(places(rows), places(columns)):
        lone = np.zeros((rows, columns))
        lone[row, column] = 1
        most = max(most, float(np.abs(slope_response(reference.solve(lone, neumann), neumann)).sum()))
    return most
