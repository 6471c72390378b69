# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/wide_substitution.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor, round_saturate
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.thomas_table import WideTable, ahead_rows, table_parts, wide_table
from tactile_depth.chip.poisson.transform.wide_row_pairs import up_positions
from tactile_depth.chip.resources import Parts, Words, delay_line, products

LATENCY = 2
LOOP = 4  # clocks from a word to the product with it and back


def wide_substitution(e: np.ndarray, config: Configuration, monitor: Monitor | None = None) -> np.ndarray:
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
        z_rows[step] = round_saturate(row, drop, width, monitor, "wide_substitution")
    return z


def table(config: Configuration) -> WideTable:
    """Return the table of the coefficients up the rows."""
    return wide_table(ahead_rows(config), up_positions(config.columns, config.lanes))


def parts(config: Configuration) -> Parts:
    lanes = config.lanes
    wait = config.columns // lanes * 2 - LOOP
    return [
        Words(lanes * config.depth.width),
        *products(config, lanes),
        *delay_line(config.arithmetic_width, wait) * lanes,
        *table_parts(table(config), lanes * config.coefficient.width),
    ]
