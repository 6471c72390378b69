# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/round_saturate.sv, and the monitor that counts what saturates where."""

from __future__ import annotations

from collections import Counter

import numpy as np


class Monitor:
    """What the nodes of one run of a model did.

    Attributes
    ----------
    saturations : Counter
        Node name to number of values clipped there (integer models).
    peak : dict
        Node name to the largest row sum of absolute values seen there. Fed with a unit matrix of floats, a
        model is its own linear map and the row sum is the L1 norm of the node's response: the largest value
        that inputs bounded by 1 can produce there.
    """

    def __init__(self) -> None:
        self.saturations: Counter[str] = Counter()
        self.peak: dict[str, float] = {}

    def clipped(self, node: str, count: int) -> None:
        if count:
            self.saturations[node] += count

    def rounded(self, node: str, values: np.ndarray) -> None:
        """Values of an integer model as they come to a node, before they are clipped."""

    def linear(self, node: str, response: np.ndarray) -> None:
        norm = float(np.abs(response).sum(axis=0).max())
        self.peak[node] = max(norm, self.peak.get(node, 0.0))


def round_half_even(x: np.ndarray, drop: int | np.ndarray) -> np.ndarray:
    """Divide integers by 2**drop, to the nearest integer, ties to even.

    Parameters
    ----------
    x : int64 array
    drop : int or int array that broadcasts against `x`
        Fraction bits dropped; a negative scalar shifts left, which is exact.

    Returns
    -------
    int64 array
    """
    if np.ndim(drop) == 0 and drop <= 0:
        return np.left_shift(x, -drop)
    # Just less than half is added, or half where the floor is odd: then a tie goes up.
    y = np.right_shift(x, drop)
    y &= 1
    y += x
    y += np.left_shift(np.int64(1), np.subtract(drop, 1)) - 1
    y >>= drop
    return y


def round_saturate(
    x: np.ndarray,
    drop: int | np.ndarray,
    width: int,
    monitor: Monitor | None = None,
    node: str = "",
) -> np.ndarray:
    """Drop `drop` fraction bits with round half to even, then clip to `width` signed bits.

    Floats pass as x / 2**drop, neither rounded nor clipped, and `monitor` is told their L1 norm: so the
    integer model of a core and its ideal linear map are one piece of code.
    """
    if np.issubdtype(x.dtype, np.floating):
        x = x / np.exp2(np.asarray(drop, float))
        if monitor is not None:
            monitor.linear(node, x)
        return x
    y = round_half_even(x, drop)
    if monitor is not None:
        monitor.rounded(node, y)
    limit = np.int64(1) << (width - 1)
    if not y.size or (y.min() >= -limit and y.max() < limit):  # as a rule
        return y
    clipped = np.clip(y, -limit, limit - 1)
    if monitor is not None:
        monitor.clipped(node, int(np.count_nonzero(clipped != y)))
    return clipped
