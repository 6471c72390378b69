# SPDX-License-Identifier: Apache-2.0
"""The three orders in which the words of a row travel."""

from __future__ import annotations

import numpy as np


def bit_reversed(size: int) -> np.ndarray:
    """DCT-II mode at each position of a transformed burst: position p carries mode bit_reversed(size)[p]."""
    index = np.arange(size)
    reversed_index = np.zeros_like(index)
    for _ in range(size.bit_length() - 1):
        reversed_index = reversed_index << 1 | index & 1
        index = index >> 1
    return reversed_index


def makhoul(size: int) -> np.ndarray:
    """Sample at each position of the burst that enters an FFT: 0, 2, 4, .., 5, 3, 1.

    J. Makhoul, A fast cosine transform in one and two dimensions, IEEE Trans. ASSP 28 (1980), equation 20.
    """
    even = np.arange(0, size, 2)
    return np.concatenate((even, size - 1 - even))


def mirror(size: int) -> np.ndarray:
    """Position of mode N - k for the position of mode k, in bit-reversed order (0 maps to itself)."""
    position = np.arange(size)
    return np.array([p ^ ((1 << max(int(p).bit_length() - 1, 0)) - 1) for p in position])


def eigenvalues(size: int, neumann: bool) -> np.ndarray:
    """Eigenvalue 2 (cos(pi k / N) - 1) of the second difference, by position in bit-reversed order, float64 (size,).

    The mode of DCT index c is that of k = c under Neumann, of k = N - c under Dirichlet (the sign (-1)^n
    reverses modes).
    """
    index = bit_reversed(size)
    return 2 * (np.cos(np.pi * (index if neumann else size - index) / size) - 1)
