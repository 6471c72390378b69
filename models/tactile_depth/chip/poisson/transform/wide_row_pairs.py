# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/transform/wide_row_pairs.sv, and the order of its words."""

from __future__ import annotations

from functools import cache

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor, round_saturate
from tactile_depth.chip.poisson.transform.mode_pairs import mode_pairs
from tactile_depth.chip.poisson.transform.orders import mirror, read_only


@cache
def up_positions(size: int, words: int) -> np.ndarray:
    """Return the position in bit-reversed order of each word of a row, int64 (size / words, words).

    Beat u has two blocks of words / 2 positions, 2 u and 2 mirror(u) + 1, so that mode k and mode N - k are together.
    """
    beats = size // words
    blocks = np.stack((2 * np.arange(beats), 2 * mirror(beats) + 1), axis=1)
    return read_only((blocks[..., None] * (words // 2) + np.arange(words // 2)).reshape(beats, words))


def rows_of_bursts(bursts: np.ndarray, alone: np.ndarray) -> np.ndarray:
    """Return bursts (count, beats, words) of two rows as rows (count, 2, N) in bit-reversed order.

    Where `alone` (count) is true, the second row is 0.
    """
    count, beats, words = bursts.shape
    size = beats // 2 * words
    order = np.argsort(up_positions(size, words), axis=None)
    rows = bursts.reshape(count, 2, size)[..., order]
    rows[np.asarray(alone, bool), 1] = 0
    return rows


def wide_row_pairs(
    a: np.ndarray, b: np.ndarray, width: int, monitor: Monitor | None = None, node: str = "pair"
) -> tuple[np.ndarray, np.ndarray]:
    """Return C[N-k] + j C[k] of rows C = a + j b (..., N) in bit-reversed order, saturated to `width` bits.

    Real part a[N-k] - b[k], imaginary part a[k] + b[N-k], int64 arrays (..., N); mode N is 0.
    """
    (a, a_mirrored), (b, b_mirrored) = mode_pairs(a), mode_pairs(b)
    re = round_saturate(a_mirrored - b, 0, width, monitor, node + ".re")
    im = round_saturate(a + b_mirrored, 0, width, monitor, node + ".im")
    return re, im


def latency(size: int, paths: int) -> int:
    """Return the latency: row b, one sum, one register in front of the memories."""
    return size // (2 * paths) + 2
