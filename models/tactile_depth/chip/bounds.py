# SPDX-License-Identifier: Apache-2.0
"""Largest magnitudes at the nodes of the solvers, from which the configuration derives its formats."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.poisson.transform.dst_forward import dst_forward
from tactile_depth.chip.poisson.transform.dst_inverse import dst_inverse
from tactile_depth.chip.poisson.transform.orders import eigenvalues, makhoul
from tactile_depth.chip.poisson.transform.transform import Transform


@dataclass(frozen=True)
class Bounds:
    """Largest magnitudes at the nodes of each core, for slopes up to 1 (first three) or depths up to 1 (others)."""

    row_forward: float
    row_modes: float
    column_forward: float
    column_inverse: float
    depth_modes: float
    row_inverse: float
    row_pair: float


def l1(response: np.ndarray) -> np.ndarray:
    """Return the L1 norm over samples, axis 0."""
    norm: np.ndarray = np.abs(response).sum(axis=0)
    return norm


def _variation(response: np.ndarray) -> np.ndarray:
    """Return the L1 norm of the response to slopes, from the response to the divergence."""
    return l1(np.diff(response, axis=0, append=0))


def wide_arithmetic(neumann: bool) -> Transform:
    """Return the formats of a nearly ideal transform of floats."""
    return Transform(0, 62, 50, 0, 62, alternate=not neumann)


@cache
def difference_bounds(rows: int, columns: int, neumann: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return the largest f[i] - d[i-1] of each mode, for slopes up to 1 and for depths up to 1, float64 (columns,).

    This difference is the sum over rows r <= i of f[r] times the product of |c| over the rows from r up to i. These
    weights rise to 1 at r = i, so their variation is below 2. In terms of depth the difference is z[i] / c[i] + z[i+1],
    and 1 / |c| is largest in the first row. The bounds hold for f alone too, the modes at the input.
    """
    eigenvalue = eigenvalues(columns, neumann)
    modes = dst_forward(np.eye(columns)[:, makhoul(columns)], wide_arithmetic(neumann))
    length = l1(modes)
    inner = np.diff(modes, axis=0, append=modes[-1:] if neumann else 0)  # Neumann: no slope across the edge
    variation = l1(inner)
    end = eigenvalue - (1 if neumann else 3)
    weights = largest = np.ones(columns)
    c = 1 / end
    for _ in range(rows - 1):
        weights = 1 + np.abs(c) * weights
        largest = np.maximum(largest, weights)
        c = 1 / (eigenvalue - 2 - c)
    return 2 * length + variation * largest, (4 - eigenvalue) * length


class Responses(Monitor):
    """Monitor that keeps the response of each node: (samples, words)."""

    def __init__(self) -> None:
        super().__init__()
        self.nodes: dict[str, np.ndarray] = {}

    def linear(self, node: str, response: np.ndarray) -> None:
        self.nodes[node] = response.reshape(len(response), -1)


@cache
def bounds(size: int, neumann: bool = False) -> Bounds:
    """Return the largest L1 norms of the nodes of the spectral solver, from the models run on unit vectors."""
    wide = wide_arithmetic(neumann)
    unit = np.eye(size)[:, makhoul(size)]  # row j: sample j alone, in burst order
    forward, inverse = Responses(), Responses()
    modes = dst_forward(unit, wide, forward, "forward")
    dst_inverse(modes, wide, inverse, "inverse")

    def largest(nodes: Responses, norm) -> float:  # type: ignore[no-untyped-def]
        return max(float(norm(response).max()) for response in nodes.nodes.values())

    def row(response: np.ndarray) -> np.ndarray:  # gx along the row, gy of this row and of the row before
        return _variation(response) + 2 * l1(response)

    def column(response: np.ndarray) -> np.ndarray:  # outer product with every row mode
        along, across = l1(response), _variation(response)
        return np.maximum.reduce([v * along + u * across for u, v in zip(l1(modes), _variation(modes), strict=True)])

    def pair() -> float:
        """Two rows in one complex transform: the real part of the one meets the imaginary part of the other."""
        norms = {name: l1(response) for name, response in inverse.nodes.items()}
        alone = [norm for name, norm in norms.items() if not name.endswith((".re", ".im"))]
        sums = [norm + norms[name[:-3] + ".im"] for name, norm in norms.items() if name.endswith(".re")]
        return max(float(norm.max()) for norm in alone + sums)

    largest_mode = float(l1(modes).max())
    return Bounds(
        row_forward=largest(forward, row),
        row_modes=float(row(modes).max()),
        column_forward=largest(forward, column),
        column_inverse=largest_mode * max(largest(inverse, l1), largest_mode),
        depth_modes=largest_mode,
        row_inverse=largest(inverse, l1),
        row_pair=pair(),
    )
