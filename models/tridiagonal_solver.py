# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/tridiagonal_solver.sv: divergence in, depth codes out, bottom row first."""

from __future__ import annotations

from typing import Any

import numpy as np

from models.back_substitution import back_substitution
from models.configuration import Configuration
from models.dst_forward import dst_forward
from models.dst_inverse import dst_inverse
from models.forward_elimination import forward_elimination, mean_reciprocal
from models.frame_stack import frame_stack
from models.round_saturate import Monitor
from models.row_reorder import row_reorder
from models.thomas_table import thomas_table


def solver_parameters(config: Configuration) -> dict[str, int]:
    """Parameters of hdl/tridiagonal_solver.sv."""
    table = thomas_table(config)
    elimination = config.elimination.fraction - config.depth_limit_log2
    reciprocal, mean_drop = mean_reciprocal(config)
    return {
        **config.transform_parameters(),
        "Rows": config.rows,
        "InWidth": config.divergence.width,
        "DataWidth": config.data_width,
        "Neumann": int(config.neumann),
        "RowForwardOut": config.row_forward.fraction - elimination,
        "StoreDrop": config.elimination.fraction - config.elimination_store.fraction,
        "RowInverseIn": config.elimination.fraction - config.row_inverse.fraction,
        "RowInverseOut": config.row_inverse.fraction - config.depth.fraction,
        "TableWords": len(table.words),
        "SettledWidth": table.settled_width,
        "LastShiftWidth": table.last_shift_width,
        "MomentDrop": config.moment_drop,
        "MeanReciprocal": reciprocal,
        "MeanDrop": mean_drop - config.moment_drop,
        "StoreStyle": config.store_style,
        "WordsPerRow": config.words_per_row,
    }


def tridiagonal_solver(f: np.ndarray, config: Configuration, monitor: Monitor | None = None) -> np.ndarray:
    """Solve the Poisson equation for frames of divergence codes.

    Parameters
    ----------
    f : int64 array (..., rows, columns), codes of `config.divergence`

    Returns
    -------
    int64 array (..., rows, columns), codes of `config.depth`, bottom row first
    """
    d = forward_elimination(row_forward(f, config, monitor), config, monitor)
    z = back_substitution(frame_stack(d), config, monitor)
    return row_inverse(z, config, monitor)


def row_forward(rows: np.ndarray, config: Configuration, monitor: Monitor | None = None) -> np.ndarray:
    """Modes of rows (..., columns) in natural order, codes of `config.elimination`."""
    return dst_forward(
        row_reorder(rows, to_burst=True),
        input_drop=0,
        output_drop=solver_parameters(config)["RowForwardOut"],
        output_width=config.arithmetic_width,
        node="row_forward",
        **_arithmetic(config, monitor),
    )


def row_inverse(modes: np.ndarray, config: Configuration, monitor: Monitor | None = None) -> np.ndarray:
    """Rows of depth in natural order."""
    parameters = solver_parameters(config)
    depth = dst_inverse(
        modes,
        input_drop=parameters["RowInverseIn"],
        output_drop=parameters["RowInverseOut"],
        output_width=config.depth.width,
        node="row_inverse",
        **_arithmetic(config, monitor),
    )
    return row_reorder(depth, to_burst=False)


def _arithmetic(config: Configuration, monitor: Monitor | None) -> dict[str, Any]:
    return {
        "width": config.arithmetic_width,
        "coefficient_width": config.coefficient_width,
        "alternate": not config.neumann,
        "monitor": monitor,
    }
