# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/wide_elimination.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor, round_saturate
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.forward_elimination import coefficient_rows, mean_products, recursion, zero_mean
from tactile_depth.chip.poisson.thomas_table import WideTable, table_parts, thomas_table, wide_table
from tactile_depth.chip.poisson.wide_stack import down_positions
from tactile_depth.chip.resources import Memory, Parts, Words, products, rom

LATENCY = 9  # from the first modes of a row to its first d, with which e of the row above leaves


def wide_elimination(f: np.ndarray, config: Configuration, monitor: Monitor | None = None) -> np.ndarray:
    """Compute d[i] = c[i] (f[i] - d[i-1]) down the rows, and e[i] = d[i] - c[i] d[i+1], which look one row ahead.

    Parameters
    ----------
    f : int64 array (..., rows, columns), codes of `config.elimination`

    Returns
    -------
    int64 array of the same shape, codes of `config.elimination_store`: e, and d in the last row
    """
    return ahead(recursion(f, config, monitor, "wide_elimination"), config, monitor)


def ahead(d: np.ndarray, config: Configuration, monitor: Monitor | None) -> np.ndarray:
    """Return the words of the frame store from the rows d (..., rows, columns) of the recursion, which may change."""
    if config.neumann:
        zero_mean(d, config, monitor, "wide_elimination")
    drop = config.elimination.fraction - config.elimination_store.fraction
    e = np.empty_like(d)
    inner = coefficient_rows(config, d.shape[-2])[:-1]
    one = 2 ** (config.coefficient.fraction)
    exact = d[..., :-1, :] * one - inner * d[..., 1:, :]
    shift = config.coefficient.fraction + drop
    e[..., :-1, :] = round_saturate(exact, shift, config.elimination_store.width, monitor, "wide_elimination.ahead")
    e[..., -1, :] = round_saturate(
        d[..., -1, :], drop, config.elimination_store.width, monitor, "wide_elimination.store"
    )
    return e


def table(config: Configuration) -> WideTable:
    """Return the table of the coefficients down the rows."""
    positions = down_positions(config.columns, config.down_words)
    return wide_table(coefficient_rows(config, config.rows)[:-1], positions)


def parts(config: Configuration) -> Parts:
    down, coefficient = config.down_words, config.coefficient.width
    clocks = config.columns // down
    return [
        Words(down * config.depth.width),
        *products(config, 2 * down),
        Memory("row buffers", down * (coefficient + config.arithmetic_width), clocks),
        *table_parts(table(config), down * coefficient),
        rom(down * (thomas_table(config).last_shift_width + coefficient), clocks),
        *mean_products(config),
    ]
