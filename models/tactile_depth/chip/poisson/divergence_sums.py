# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/divergence_sums.sv: sums of each row of the divergence, times a constant."""

from __future__ import annotations

import numpy as np

SUMS = 4  # of a row: of all columns but the last, then of the minus signs of each pattern
LATENCY_BEHIND_STEPS = (
    4  # cycles from the last word of a row to its first sum, beside a cycle for each bit of the scale
)


def sums(columns: int) -> np.ndarray:
    """Return the columns of each sum, int64 (`SUMS`, columns) of 1 and 0, which is 0 in the last column.

    The first sum is of all other columns. The others are of those with a minus sign in a pattern. Pattern p is the
    sequence of Rudin and Shapiro, each sign 2**p times: minus where the column's number, without its p lowest bits, has
    an odd number of neighbouring ones. Such a sequence is flat in frequency, unlike a Walsh function, so no mode is
    nearly orthogonal to it. The last pattern has opposite signs in columns as far from the middle: in the others an
    error that is opposite there may cancel.
    """
    column = np.arange(columns)
    right = column >= columns // 2
    folded = np.where(right, columns - 1 - column, column)
    patterns = [signs(column, 0), signs(column, 1), signs(folded, 2) ^ right]
    return np.where(column < columns - 1, np.array([column >= 0, *patterns]), 0).astype(np.int64)


def signs(column: np.ndarray, runs_log2: int) -> np.ndarray:
    """Return where the signs of Rudin and Shapiro are minus, each of them 2**runs_log2 times."""
    pairs = (column & column >> 1) >> runs_log2
    return np.array([int(pair).bit_count() % 2 for pair in pairs])


def begin(columns: int, dropped: int) -> np.ndarray:
    """Return what each sum begins with, int64 (`SUMS`,): what dropped bits take from it on average."""
    return sums(columns).sum(axis=1) // 2 if dropped else np.zeros(SUMS, np.int64)


def divergence_sums(f: np.ndarray, dropped: int, scale: int, scale_fraction: int) -> np.ndarray:
    """Return the scaled sums of rows of divergence codes.

    Parameters
    ----------
    f : int64 array (..., columns)

    Returns
    -------
    int64 array (..., `SUMS`), before it wraps
    """
    columns = f.shape[-1]
    return ((f >> dropped) @ sums(columns).T + begin(columns, dropped)) * scale >> scale_fraction
