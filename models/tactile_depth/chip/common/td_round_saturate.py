# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/common/td_round_saturate.sv, and the monitor that counts saturated values by node."""

from __future__ import annotations

from collections import Counter
from functools import cache

import numpy as np


class Monitor:
    """Record of the nodes in one run of a model.

    Attributes
    ----------
    saturations : Counter
        Node name to the number of values clipped at that node (integer models).
    """

    def __init__(self) -> None:
        self.saturations: Counter[str] = Counter()

    def clipped(self, node: str, count: int) -> None:
        if count:
            self.saturations[node] += count

    def rounded(self, node: str, values: np.ndarray) -> None:
        """Take the values of an integer model at a node, before they are clipped."""

    def linear(self, node: str, response: np.ndarray) -> None:
        """Take the values of a model of floats at a node.

        A model that is run on a unit matrix returns its own linear map. Then the sum of absolute values over axis 0 is
        the L1 norm of the node's response, the largest value that inputs bounded by 1 can produce at the node.
        """


@cache
def _constant(number: int) -> np.ndarray:
    """Return a number as an int64 array without axes, which numpy takes three times as fast as a Python integer."""
    constant = np.array(number, np.int64)
    constant.flags.writeable = False
    return constant


def round_half_even(x: np.ndarray, drop: int | np.ndarray) -> np.ndarray:
    """Divide integers by 2**drop, to the nearest integer, ties to even.

    Parameters
    ----------
    x : int64 array
    drop : int or int array that broadcasts against `x`
        Fraction bits dropped; a negative scalar shifts left, which is exact.

    Returns
    -------
    int64 array, `x` itself where nothing is dropped
    """
    if isinstance(drop, np.ndarray):
        shift, below_half = drop, np.left_shift(np.int64(1), drop - 1) - 1
    elif drop <= 0:
        return np.left_shift(x, -drop) if drop else x
    else:
        shift, below_half = _constant(drop), _constant((1 << (drop - 1)) - 1)
    # The addend is just below a half, or a half where the zero offset is odd, so that a tie rounds to even.
    y = np.right_shift(x, shift)
    y &= _constant(1)
    y += x
    y += below_half
    y >>= shift
    return y


def round_saturate(
    x: np.ndarray,
    drop: int | np.ndarray,
    width: int,
    monitor: Monitor | None = None,
    node: str = "",
) -> np.ndarray:
    """Drop `drop` fraction bits with round half to even, then clip to `width` signed bits.

    Floats are returned as x / 2**drop, neither rounded nor clipped, and `monitor` receives them. So one function serves
    both the integer model of a core and its ideal linear map.
    """
    if x.dtype.kind == "f":
        x = np.ldexp(x, -np.asarray(drop))  # exact; exp2 of some processors is not
        if monitor is not None:
            monitor.linear(node, x)
        return x
    y = round_half_even(x, drop)
    limit = 1 << (width - 1)
    clipped = y.clip(_constant(-limit), _constant(limit - 1))
    if monitor is not None:
        monitor.rounded(node, y)
        monitor.clipped(node, int(np.count_nonzero(clipped != y)))
    return clipped
