# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/back_substitution.sv."""

from __future__ import annotations

import numpy as np

from models.configuration import Configuration
from models.round_saturate import Monitor, round_saturate
from models.thomas_table import thomas_table


def back_substitution(
    d: np.ndarray, config: Configuration, monitor: Monitor | None = None, node: str = "back_substitution"
) -> np.ndarray:
    """z[i] = d[i] - c[i] z[i+1] from the last row up.

    Parameters
    ----------
    d : int64 array (..., rows, columns), codes of `config.elimination_store`, last row first

    Returns
    -------
    int64 array of the same shape and order, codes of `config.elimination`
    """
    rows = d.shape[-2]
    coefficients = thomas_table(config).rows(rows - 1)
    lift = config.elimination.fraction - config.elimination_store.fraction
    drop = config.coefficient_width - 1
    z = np.empty_like(d)
    state = np.zeros_like(d[..., 0, :])
    for step in range(rows):
        product = coefficients[rows - 1 - step] * state if step else state
        exact = d[..., step, :] * 2 ** (lift + drop) - product
        state = round_saturate(exact, drop, config.arithmetic_width, monitor, node)
        z[..., step, :] = state
    return z
