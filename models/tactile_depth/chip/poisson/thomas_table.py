# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/thomas_table.sv: the compressed table of Thomas's algorithm.

For the mode of eigenvalue lambda the rows of a frame form a tridiagonal system with off-diagonals 1. Its elimination
(L. H. Thomas, 1949; Press et al., Numerical Recipes, section 2.4) needs c[0] = 1 / b[0], c[i] = 1 / (b[i] - c[i-1]),
with b the diagonal: lambda - 2, and at the two ends lambda - 3 (Dirichlet) or lambda - 1 (Neumann).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.transform.orders import eigenvalues
from tactile_depth.chip.resources import Memory, late_style, rom

LATENCY = 5


@dataclass(frozen=True)
class PackedTable:
    """Coefficients of several positions side by side in a word, compressed as those of one position.

    Attributes
    ----------
    words : int64 array (count, positions in a word), the coefficients of row i and clock t of a burst at
        base[t] + min(i, settled[t]), where the last of the positions settles
    base, settled : int64 arrays (clocks of a burst,)
    """

    words: np.ndarray
    base: np.ndarray
    settled: np.ndarray

    @property
    def settled_width(self) -> int:
        return max(1, int(self.settled.max()).bit_length())

    @property
    def index_width(self) -> int:
        """Bits of an index: the place of the words of a clock, and `settled`."""
        return (len(self.words) - 1).bit_length() + self.settled_width

    @property
    def index(self) -> np.ndarray:
        """Words {base, settled}, int64 (clocks of a burst,)."""
        return self.base << self.settled_width | self.settled


@dataclass(frozen=True)
class ThomasTable(PackedTable):
    """Coefficients c[i] of each position as words of the coefficient width; the last row is stored separately.

    A column of the table settles; values after its last change are not stored.

    Attributes
    ----------
    words : int64 array, c[i] of position p at base[p] + min(i, settled[p]), one position after another
    base, settled : int64 arrays (columns,)
    last, last_shift : int64 arrays (columns,)
        c of the last row is last * 2**(last_shift + 1 - coefficient_width). Under Neumann it is large for the lowest
        modes, and 0 for the singular mode.
    """

    last: np.ndarray
    last_shift: np.ndarray

    @property
    def last_shift_width(self) -> int:
        return max(1, int(self.last_shift.max()).bit_length())

    def rows(self, count: int) -> np.ndarray:
        """Return the first `count` rows of the uncompressed table, int64 (count, columns), without the last row."""
        index = np.minimum(np.arange(count)[:, None], self.settled)
        return self.words[self.base + index]


@cache
def _exact(config: Configuration) -> tuple[np.ndarray, np.ndarray]:
    """Return c of all rows but the last, float64 (rows - 1, columns), and c of the last row, (columns,)."""
    eigenvalue = eigenvalues(config.columns, config.neumann)
    end = eigenvalue - (1 if config.neumann else 3)
    full = np.empty((config.rows - 1, config.columns))
    c = 1 / end
    for row in range(config.rows - 1):
        full[row] = c
        c = 1 / (eigenvalue - 2 - c)
    pivot = end - full[-1]
    singular = np.abs(pivot) < 1e-9
    return full, np.where(singular, 0, 1 / np.where(singular, 1, pivot))


def _codes(values: np.ndarray, config: Configuration) -> np.ndarray:
    """Return negative values down to -1 as words of the coefficient width; the smallest is -1 code."""
    scale = 2**config.coefficient.fraction
    return np.clip(np.rint(values * scale), -scale, -1).astype(np.int64)


def _settled(codes: np.ndarray) -> np.ndarray:
    """Return the row of the last change of each position, from codes (rows, positions)."""
    changed = codes != codes[-1]
    return np.where(changed.any(axis=0), len(codes) - np.argmax(changed[::-1], axis=0), 0)


@cache
def thomas_table(config: Configuration) -> ThomasTable:
    """Compute the table in double precision, round it and compress it."""
    full, last = _exact(config)
    codes = _codes(full, config)
    settled = _settled(codes)
    base = np.concatenate(([0], np.cumsum(settled + 1)[:-1]))
    words = np.concatenate([codes[: settled[p] + 1, p] for p in range(config.columns)])
    shift = np.maximum(np.frexp(last)[1], 0).astype(np.int64)
    scale = 2**config.coefficient.fraction
    return ThomasTable(words, base, settled, np.rint(last * scale / 2.0**shift).astype(np.int64), shift)


def ahead_rows(config: Configuration) -> np.ndarray:
    """Return the coefficients -c[i] c[i+1] of the substitution that looks ahead, int64 (rows - 2, columns).

    They are rounded from the exact product, and the sign lets the word of -1 hold a product of 1.
    """
    full, _ = _exact(config)
    return _codes(-full[:-1] * full[1:], config)


def packed_table(codes: np.ndarray, positions: np.ndarray) -> PackedTable:
    """Compress coefficients (rows, columns) for bursts whose clocks take `positions` (clocks, positions in a word)."""
    bursts = codes[:, positions]  # (rows, clocks, positions)
    settled = np.array([_settled(bursts[:, clock]).max() for clock in range(len(positions))])
    base = np.concatenate(([0], np.cumsum(settled + 1)[:-1]))
    words = np.concatenate([bursts[: last + 1, clock] for clock, last in enumerate(settled)])
    return PackedTable(words, base, settled)


def table_parts(table: PackedTable, width: int) -> list[Memory]:
    """Return the two ROMs of a table of words of `width` bits, without that of the last row."""
    index = rom(table.index_width, len(table.base), late_style(table.index_width * len(table.base)))
    return [rom(width, len(table.words)), index]
