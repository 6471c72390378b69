# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/forward_elimination.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor, round_saturate
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.thomas_table import table_parts, thomas_table
from tactile_depth.chip.resources import Memory, Multiplier, Parts, Words, products, rom

LATENCY = 9


def mean_reciprocal(config: Configuration) -> tuple[int, int]:
    """Return mantissa and drop of 1 / rows = mantissa * 2**-drop; the mantissa has coefficient_width signed bits."""
    drop = config.coefficient.width - 2 + (config.rows - 1).bit_length()
    return round(2**drop / config.rows), drop


def forward_elimination(f: np.ndarray, config: Configuration, monitor: Monitor | None = None) -> np.ndarray:
    """Compute d[i] = c[i] (f[i] - d[i-1]) down the rows of modes (..., rows, columns), codes of `config.elimination`.

    The result has codes of `config.elimination_store`.

    Under Neumann the constant of the singular mode (position 0) is chosen so that its column has zero mean. A last row
    of 0 would give the mean sum over i of (i + 1) d[i] / rows; the last row is minus this mean.
    """
    return stored(recursion(f, config, monitor, "forward_elimination"), config, monitor)


def recursion(f: np.ndarray, config: Configuration, monitor: Monitor | None, node: str) -> np.ndarray:
    """Return the rows d of `forward_elimination` before they are stored, int64 (..., rows, columns)."""
    width, drop = config.arithmetic_width, config.coefficient.fraction
    f_rows = np.ascontiguousarray(np.moveaxis(f, -2, 0))
    d = np.empty(f.shape, f.dtype)
    state = np.zeros_like(f_rows[0])
    rows = zip(f_rows, coefficient_rows(config, len(f_rows)), np.moveaxis(d, -2, 0), strict=True)
    for f_row, coefficients, d_row in rows:
        x = round_saturate(f_row - state, 0, width, monitor, node + ".difference")
        state = d_row[...] = round_saturate(x * coefficients, drop, width, monitor, node + ".state")
    return d


def coefficient_rows(config: Configuration, rows: int) -> np.ndarray:
    """Return c of each row, int64 (rows, columns)."""
    table = thomas_table(config)
    return np.concatenate((table.rows(rows - 1), [table.last << table.last_shift]))


def stored(d: np.ndarray, config: Configuration, monitor: Monitor | None) -> np.ndarray:
    """Return the words of the frame store from the rows of the recursion.

    Under Neumann the last row of mode 0 is first written into `d`: see `forward_elimination`.
    """
    if config.neumann:
        zero_mean(d, config, monitor, "forward_elimination")
    return round_saturate(
        d,
        config.elimination.fraction - config.elimination_store.fraction,
        config.elimination_store.width,
        monitor,
        "forward_elimination.store",
    )


def zero_mean(d: np.ndarray, config: Configuration, monitor: Monitor | None, node: str) -> None:
    """Write the last row of mode 0 into the rows d (..., rows, columns): see `forward_elimination`."""
    rows, width = d.shape[-2], config.arithmetic_width
    reciprocal, mean_drop = mean_reciprocal(config)
    moment = (d[..., :-1, 0] * np.arange(1, rows)).sum(axis=-1)
    mean = round_saturate(moment, config.moment_drop, width, monitor, node + ".moment")
    d[..., -1, 0] = round_saturate(-mean * reciprocal, mean_drop - config.moment_drop, width, monitor, node + ".mean")


def parts(config: Configuration) -> Parts:
    last = rom(thomas_table(config).last_shift_width + config.coefficient.width, config.columns)
    return [*thomas_parts(config), last, *mean_products(config)]


def thomas_parts(config: Configuration) -> Parts:
    """Return those of an elimination or a substitution of a word per clock."""
    return [
        Words(config.depth.width),
        *products(config, 1),
        Memory("row buffers", config.arithmetic_width, config.columns),
        *table_parts(thomas_table(config), config.coefficient.width),
    ]


def mean_products(config: Configuration) -> list[Multiplier]:
    """Return the products of column_mean.sv, which only Neumann has."""
    row_number = (config.rows - 1).bit_length() + 2  # 1 to rows, signed
    return [Multiplier(config.arithmetic_width, row_number), *products(config, 1)] * config.neumann
