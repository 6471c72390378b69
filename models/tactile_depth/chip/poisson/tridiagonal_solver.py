# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/tridiagonal_solver.sv: divergence in, depth codes out, bottom row first."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.fixed_point import Format
from tactile_depth.chip.poisson.back_substitution import LATENCY as BACK_SUBSTITUTION
from tactile_depth.chip.poisson.cores import NUMPY, Cores
from tactile_depth.chip.poisson.forward_elimination import LATENCY as FORWARD_ELIMINATION
from tactile_depth.chip.poisson.forward_elimination import mean_reciprocal
from tactile_depth.chip.poisson.frame_stack import LATENCY as FRAME_STACK
from tactile_depth.chip.poisson.frame_stack import frame_stack
from tactile_depth.chip.poisson.thomas_table import thomas_table
from tactile_depth.chip.poisson.transform.dst_forward import latency as forward_latency
from tactile_depth.chip.poisson.transform.dst_inverse import latency as inverse_latency
from tactile_depth.chip.poisson.transform.row_reorder import LATENCY as ROW_REORDER
from tactile_depth.chip.poisson.transform.row_reorder import row_reorder


def solver_parameters(config: Configuration) -> dict[str, int]:
    """Parameters of hdl/poisson/tridiagonal_solver.sv."""
    table = thomas_table(config)
    reciprocal, mean_drop = mean_reciprocal(config)
    return {
        **config.solver_parameters(),
        "Rows": config.rows,
        "Neumann": int(config.neumann),
        # Slopes have the unit `unit_px`.
        "RowForwardOut": config.row_forward.fraction + config.depth_limit_log2 - config.elimination.fraction,
        "StoreDrop": config.elimination.fraction - config.elimination_store.fraction,
        "RowInverseIn": row_inverse_drops(config)[0],
        "RowInverseOut": row_inverse_drops(config)[1],
        "TableWords": len(table.words),
        "SettledWidth": table.settled_width,
        "LastShiftWidth": table.last_shift_width,
        "MomentDrop": config.moment_drop,
        "MeanReciprocal": reciprocal,
        "MeanDrop": mean_drop - config.moment_drop,
        "StoreStyle": config.store_style,
        "WordsPerRow": config.words_per_row,
    }


def row_inverse_drops(config: Configuration) -> tuple[int, int]:
    """Return the fraction bits that the inverse row transform drops at its input and at its output."""
    return (
        config.elimination.fraction - config.row_inverse.fraction,
        config.row_inverse.fraction - config.depth.fraction,
    )


def tridiagonal_solver(
    f: np.ndarray, config: Configuration, monitor: Monitor | None = None, cores: Cores = NUMPY
) -> np.ndarray:
    """Solve the Poisson equation for frames of divergence codes.

    Parameters
    ----------
    f : int64 array (..., rows, columns), codes of `config.divergence`

    Returns
    -------
    int64 array (..., rows, columns), codes of `config.depth`, bottom row first
    """
    d = cores.forward_elimination(row_forward(f, config, monitor, cores), config, monitor)
    z = cores.back_substitution(frame_stack(d), config, monitor)
    return row_inverse(z, config, monitor, cores)


def row_forward(
    rows: np.ndarray, config: Configuration, monitor: Monitor | None = None, cores: Cores = NUMPY
) -> np.ndarray:
    """Return the modes of rows (..., columns) in natural order, codes of `config.elimination`."""
    modes = Format(config.arithmetic_width, config.elimination.fraction - config.depth_limit_log2)
    formats = config.transform(config.row_forward, config.row_forward, modes)
    return cores.dst_forward(row_reorder(rows, to_burst=True), formats, monitor, "row_forward")


def row_inverse(
    modes: np.ndarray, config: Configuration, monitor: Monitor | None = None, cores: Cores = NUMPY
) -> np.ndarray:
    """Return rows of depth in natural order from their modes (..., rows, columns), two at a time with several lanes."""
    formats = config.transform(config.elimination, config.row_inverse, config.depth)
    inverse = cores.wide_dst_inverse if config.lanes > 1 else cores.dst_inverse
    depth = inverse(modes, formats, monitor, "row_inverse")
    return row_reorder(depth, to_burst=False)


def latency_by_core(size: int) -> list[tuple[str, int]]:
    """Return cores and cycles from the last divergence word of a frame to its first depth, for any gaps."""
    return [
        ("row_reorder", ROW_REORDER),
        ("dst_forward, of the last row", forward_latency(size)),
        ("forward_elimination", FORWARD_ELIMINATION),
        ("frame_stack, turns the order of the rows", FRAME_STACK),
        ("back_substitution", BACK_SUBSTITUTION),
        ("dst_inverse, of the first row out", inverse_latency(size)),
        ("row_reorder, waits for the whole row", size - 1 + ROW_REORDER),
    ]
