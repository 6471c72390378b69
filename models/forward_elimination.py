# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/forward_elimination.sv."""

from __future__ import annotations

import numpy as np

from models.configuration import Configuration
from models.round_saturate import Monitor, round_saturate
from models.thomas_table import thomas_table


def mean_reciprocal(config: Configuration) -> tuple[int, int]:
    """1 / rows as mantissa and drop: mantissa * 2**-drop, mantissa of coefficient_width bits, signed."""
    drop = config.coefficient_width - 2 + (config.rows - 1).bit_length()
    return round(2**drop / config.rows), drop


def forward_elimination(
    f: np.ndarray, config: Configuration, monitor: Monitor | None = None, node: str = "forward_elimination"
) -> np.ndarray:
    """d[i] = c[i] (f[i] - d[i-1]) down the rows of modes (..., rows, columns), codes of `config.elimination`.

    Returns codes of `config.elimination_store`.

    Under Neumann the constant of the singular mode (position 0) is chosen so that its column has zero mean: its last
    row is minus the mean that the substitution would give with 0 there, sum over i of (i + 1) d[i] / rows.
    """
    table = thomas_table(config)
    rows, width, drop = f.shape[-2], config.arithmetic_width, config.coefficient_width - 1
    coefficients = table.rows(rows - 1)
    d = np.empty_like(f)
    state = np.zeros_like(f[..., 0, :])
    moment = np.zeros_like(f[..., 0, 0])
    for row in range(rows):
        x = round_saturate(f[..., row, :] - state, 0, width, monitor, node + ".difference")
        if row < rows - 1:
            state = round_saturate(x * coefficients[row], drop, width, monitor, node + ".state")
            moment = moment + (row + 1) * state[..., 0]
        else:
            state = round_saturate(x * table.last * (1 << table.last_shift), drop, width, monitor, node + ".state")
            if config.neumann:
                reciprocal, mean_drop = mean_reciprocal(config)
                mean = round_saturate(moment, config.moment_drop, width, monitor, node + ".moment")
                state[..., 0] = round_saturate(
                    -mean * reciprocal, mean_drop - config.moment_drop, width, monitor, node + ".mean"
                )
        d[..., row, :] = state
    return round_saturate(
        d,
        config.elimination.fraction - config.elimination_store.fraction,
        config.data_width,
        monitor,
        node + ".store",
    )
