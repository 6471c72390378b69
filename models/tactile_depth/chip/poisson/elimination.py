# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/elimination.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor, round_saturate
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.thomas_table import PackedTable, packed_table, table_parts, thomas_table
from tactile_depth.chip.resources import Memory, Multiplier, Parts, Words, products, rom

LATENCY = 9  # from the first modes of a row to its first d, with which e of the row above leaves


def elimination(f: np.ndarray, config: Configuration, monitor: Monitor | None = None) -> np.ndarray:
    """Compute d[i] = c[i] (f[i] - d[i-1]) down the rows, and e[i] = d[i] - c[i] d[i+1], which look one row ahead.

    Parameters
    ----------
    f : int64 array (..., rows, columns), codes of `config.elimination`

    Returns
    -------
    int64 array of the same shape, codes of `config.elimination_store`: e, and d in the last row
    """
    return ahead(recursion(f, config, monitor), config, monitor)


def recursion(f: np.ndarray, config: Configuration, monitor: Monitor | None) -> np.ndarray:
    """Return the rows d, int64 (..., rows, columns)."""
    width, drop = config.arithmetic_width, config.coefficient.fraction
    f_rows = np.ascontiguousarray(np.moveaxis(f, -2, 0))
    d = np.empty(f.shape, f.dtype)
    state = np.zeros_like(f_rows[0])
    rows = zip(f_rows, coefficient_rows(config, len(f_rows)), np.moveaxis(d, -2, 0), strict=True)
    for f_row, coefficients, d_row in rows:
        x = round_saturate(f_row - state, 0, width, monitor, "elimination.difference")
        state = d_row[...] = round_saturate(x * coefficients, drop, width, monitor, "elimination.state")
    return d


def coefficient_rows(config: Configuration, rows: int) -> np.ndarray:
    """Return c of each row, int64 (rows, columns)."""
    table = thomas_table(config)
    return np.concatenate((table.rows(rows - 1), [table.last << table.last_shift]))


def ahead(d: np.ndarray, config: Configuration, monitor: Monitor | None) -> np.ndarray:
    """Return the words of the frame store from the rows d (..., rows, columns) of the recursion, which may change."""
    if config.neumann:
        zero_mean(d, config, monitor)
    drop = config.elimination.fraction - config.elimination_store.fraction
    e = np.empty_like(d)
    inner = coefficient_rows(config, d.shape[-2])[:-1]
    one = 2**config.coefficient.fraction
    exact = d[..., :-1, :] * one - inner * d[..., 1:, :]
    shift = config.coefficient.fraction + drop
    e[..., :-1, :] = round_saturate(exact, shift, config.elimination_store.width, monitor, "elimination.ahead")
    e[..., -1, :] = round_saturate(d[..., -1, :], drop, config.elimination_store.width, monitor, "elimination.store")
    return e


def zero_mean(d: np.ndarray, config: Configuration, monitor: Monitor | None) -> None:
    """Write the last row of mode 0 into the rows d (..., rows, columns), so that its column has zero mean.

    Under Neumann this mode is singular. A last row of 0 would give the mean sum over i of (i + 1) d[i] / rows; the last
    row is minus this mean.
    """
    rows, width = d.shape[-2], config.arithmetic_width
    reciprocal, mean_drop = mean_reciprocal(config)
    moment = (d[..., :-1, 0] * np.arange(1, rows)).sum(axis=-1)
    mean = round_saturate(moment, config.moment_drop, width, monitor, "elimination.moment")
    d[..., -1, 0] = round_saturate(
        -mean * reciprocal, mean_drop - config.moment_drop, width, monitor, "elimination.mean"
    )


def mean_reciprocal(config: Configuration) -> tuple[int, int]:
    """Return mantissa and drop of 1 / rows = mantissa * 2**-drop; the mantissa has coefficient_width signed bits."""
    drop = config.coefficient.width - 2 + (config.rows - 1).bit_length()
    return round(2**drop / config.rows), drop


def down_positions(config: Configuration) -> np.ndarray:
    """Return the positions of each clock on the way down, int64 (clocks, words)."""
    return np.arange(config.columns).reshape(-1, config.down_words)


def table(config: Configuration) -> PackedTable:
    """Return the table of the coefficients down the rows."""
    return packed_table(coefficient_rows(config, config.rows)[:-1], down_positions(config))


def parts(config: Configuration) -> Parts:
    down, coefficient = config.down_words, config.coefficient.width
    clocks = config.columns // down
    return [
        Words(down * config.depth.width, work=1 / down),
        *products(config, 2 * down),
        Memory("row buffers", down * config.arithmetic_width, clocks),
        Memory("row buffers", down * coefficient, clocks),
        *table_parts(table(config), down * coefficient),
        rom(down * (thomas_table(config).last_shift_width + coefficient), clocks),
        *mean_products(config),
    ]


def mean_products(config: Configuration) -> list[Multiplier]:
    """Return the products of column_mean.sv, which only Neumann has."""
    row_number = (config.rows - 1).bit_length() + 2  # 1 to rows, signed
    return [Multiplier(config.arithmetic_width, row_number), *products(config, 1)] * config.neumann
