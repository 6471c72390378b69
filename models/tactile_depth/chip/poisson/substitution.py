# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/substitution.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor, round_saturate
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.thomas_table import PackedTable, ahead_rows, packed_table, table_parts
from tactile_depth.chip.resources import Memory, Parts, Words, products

LATENCY = 2
LOOP = 4  # clocks from a word to the product with it and back


def substitution(e: np.ndarray, config: Configuration, monitor: Monitor | None = None) -> np.ndarray:
    """Compute z[i] = e[i] + c[i] c[i+1] z[i+2] from the last row up.

    Parameters
    ----------
    e : int64 array (..., rows, columns), codes of `config.elimination_store`, last row first

    Returns
    -------
    int64 array of the same shape and order, codes of `config.elimination`
    """
    width, drop = config.arithmetic_width, config.coefficient.fraction
    coefficients = ahead_rows(config)[::-1]
    lift = config.elimination.fraction - config.elimination_store.fraction
    exact = np.moveaxis(e, -2, 0) * 2 ** (lift + drop)
    z = np.empty(e.shape, e.dtype)
    z_rows = np.moveaxis(z, -2, 0)
    for step, row in enumerate(exact):
        if step >= 2:
            row -= coefficients[step - 2] * z_rows[step - 2]
        z_rows[step] = round_saturate(row, drop, width, monitor, "substitution")
    return z


def pair_rows(config: Configuration) -> np.ndarray:
    """Return the coefficients of pairs of rows, int64 (pairs, 2, columns): the lower row and the upper one.

    Pair 0 has the first row of the frame; with an odd number of rows it is alone, and the one beside it does not count.
    """
    rows = ahead_rows(config)
    padded = np.concatenate((rows[:1], rows)) if len(rows) % 2 else rows
    return padded.reshape(-1, 2, config.columns)[:, ::-1]


def table(config: Configuration) -> PackedTable:
    """Return the table of the coefficients up the rows."""
    positions = np.arange(config.columns).reshape(-1, 1, config.up_paths) + np.array([[0], [config.columns]])
    return packed_table(pair_rows(config).reshape(-1, 2 * config.columns), positions.reshape(len(positions), -1))


def parts(config: Configuration) -> Parts:
    words, beats = 2 * config.up_paths, config.columns // config.up_paths
    return [
        Words(words * config.depth.width, work=1 / words),
        *products(config, words),
        *[Memory("row buffers", config.arithmetic_width, beats)] * (words if beats > LOOP else 0),
        *table_parts(table(config), words * config.coefficient.width),
    ]
