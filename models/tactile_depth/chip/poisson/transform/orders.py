# SPDX-License-Identifier: Apache-2.0
"""The three orders of the words of a row: natural, Makhoul and bit-reversed."""

from __future__ import annotations

from functools import cache

import numpy as np


def read_only(table: np.ndarray) -> np.ndarray:
    """Return the same array, locked against writes, because cached tables are shared."""
    table.flags.writeable = False
    return table


@cache
def bit_reversed(size: int) -> np.ndarray:
    """Return the DCT-II mode at each position of a transformed burst: position p holds mode bit_reversed(size)[p]."""
    index = np.arange(size)
    reversed_index = np.zeros_like(index)
    for _ in range(size.bit_length() - 1):
        reversed_index = reversed_index << 1 | index & 1
        index = index >> 1
    return read_only(reversed_index)


@cache
def makhoul(size: int) -> np.ndarray:
    """Return the sample at each position of the burst that enters an FFT: 0, 2, 4, .., 5, 3, 1.

    J. Makhoul, A fast cosine transform in one and two dimensions, IEEE Trans. ASSP 28 (1980), equation 20.
    """
    even = np.arange(0, size, 2)
    return read_only(np.concatenate((even, size - 1 - even)))


@cache
def natural(size: int) -> np.ndarray:
    """Return the position of each sample in a burst in Makhoul order, the inverse of `makhoul`."""
    return read_only(np.argsort(makhoul(size)))


@cache
def mirror(size: int) -> np.ndarray:
    """Return the position of mode N - k for the position of mode k, in bit-reversed order (0 maps to itself)."""
    position = np.arange(size)
    return read_only(np.array([p ^ ((1 << max(int(p).bit_length() - 1, 0)) - 1) for p in position]))


def eigenvalues(size: int, neumann: bool) -> np.ndarray:
    """Return eigenvalues 2 (cos(pi k / N) - 1) of the second difference by bit-reversed position, float64 (size,).

    The mode with DCT index c has k = c under Neumann and k = N - c under Dirichlet, because the sign (-1)^n reverses
    the modes.
    """
    index = bit_reversed(size)
    return 2 * (np.cos(np.pi * (index if neumann else size - index) / size) - 1)
