# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/back_substitution.sv."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor, round_saturate
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.forward_elimination import thomas_parts
from tactile_depth.chip.poisson.thomas_table import thomas_table

LATENCY = 8


def back_substitution(d: np.ndarray, config: Configuration, monitor: Monitor | None = None) -> np.ndarray:
    """Compute z[i] = d[i] - c[i] z[i+1] from the last row up.

    Parameters
    ----------
    d : int64 array (..., rows, columns), codes of `config.elimination_store`, last row first

    Returns
    -------
    int64 array of the same shape and order, codes of `config.elimination`
    """
    rows, width, drop = d.shape[-2], config.arithmetic_width, config.coefficient.fraction
    coefficients = thomas_table(config).rows(rows - 1)[::-1]
    lift = config.elimination.fraction - config.elimination_store.fraction
    exact = np.moveaxis(d, -2, 0) * 2 ** (lift + drop)
    z = np.empty(d.shape, d.dtype)
    z_rows = np.moveaxis(z, -2, 0)
    state = z_rows[0] = round_saturate(exact[0], drop, width, monitor, "back_substitution")
    for step in range(1, rows):
        state = round_saturate(exact[step] - coefficients[step - 1] * state, drop, width, monitor, "back_substitution")
        z_rows[step] = state
    return z


parts = thomas_parts
