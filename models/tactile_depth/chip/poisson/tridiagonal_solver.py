# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/tridiagonal_solver.sv: divergence in, depth codes out, bottom row first.

All numbers of depth values per clock give the same codes.
"""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.fixed_point import Format
from tactile_depth.chip.poisson import elimination, substitution
from tactile_depth.chip.poisson.cores import NUMPY, Cores
from tactile_depth.chip.poisson.elimination import mean_reciprocal
from tactile_depth.chip.poisson.frame_stack import frame_stack
from tactile_depth.chip.poisson.frame_stack import latency as stack_latency
from tactile_depth.chip.poisson.thomas_table import PackedTable, thomas_table
from tactile_depth.chip.poisson.transform.commutator import LEAD
from tactile_depth.chip.poisson.transform.corner_turn import corner_turn
from tactile_depth.chip.poisson.transform.corner_turn import latency as corner_latency
from tactile_depth.chip.poisson.transform.dst_forward import latency as forward_latency
from tactile_depth.chip.poisson.transform.dst_inverse import latency as inverse_latency
from tactile_depth.chip.poisson.transform.row_order import LATENCY as ROW_ORDER
from tactile_depth.chip.poisson.transform.row_order import row_order


def tables(config: Configuration) -> tuple[PackedTable, PackedTable]:
    """Return the tables of the coefficients down and up the rows."""
    return elimination.table(config), substitution.table(config)


def solver_parameters(config: Configuration) -> dict[str, int]:
    """Parameters of hdl/poisson/tridiagonal_solver.sv."""
    down, up = tables(config)
    reciprocal, mean_drop = mean_reciprocal(config)
    return {
        **config.solver_parameters(),
        "Rows": config.rows,
        "Neumann": int(config.neumann),
        # Slopes have the unit `unit_px`.
        "RowForwardOut": config.row_forward.fraction + config.depth_limit_log2 - config.elimination.fraction,
        "StoreDrop": config.elimination.fraction - config.elimination_store.fraction,
        "RowInverseIn": config.elimination.fraction - config.row_inverse.fraction,
        "RowInverseOut": config.row_inverse.fraction - config.depth.fraction,
        "DownWords": config.down_words,
        "DownTableWords": len(down.words),
        "DownSettledWidth": down.settled_width,
        "LastShiftWidth": thomas_table(config).last_shift_width,
        "UpTableWords": len(up.words),
        "UpSettledWidth": up.settled_width,
        "MomentDrop": config.moment_drop,
        "MeanReciprocal": reciprocal,
        "MeanDrop": mean_drop - config.moment_drop,
        "StoreStyle": config.store_style,
        "WordsPerRow": config.words_per_row,
    }


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
    e = cores.elimination(row_forward(f, config, monitor, cores), config, monitor)
    z = cores.substitution(frame_stack(e), config, monitor)
    return row_inverse(z, config, monitor, cores)


def row_forward(
    rows: np.ndarray, config: Configuration, monitor: Monitor | None = None, cores: Cores = NUMPY
) -> np.ndarray:
    """Return the modes of rows (..., columns) in natural order, codes of `config.elimination`."""
    modes = Format(config.arithmetic_width, config.elimination.fraction - config.depth_limit_log2)
    formats = config.transform(config.row_forward, config.row_forward, modes)
    return cores.dst_forward(row_order(rows), formats, monitor, "row_forward")


def row_inverse(
    modes: np.ndarray, config: Configuration, monitor: Monitor | None = None, cores: Cores = NUMPY
) -> np.ndarray:
    """Return rows of depth in natural order from their modes (..., rows, columns), two at a time."""
    formats = config.transform(config.elimination, config.row_inverse, config.depth)
    return corner_turn(cores.dst_inverse_pairs(modes, formats, monitor, "row_inverse"))


def latency_by_core(config: Configuration) -> list[tuple[str, int]]:
    """Return cores and cycles from the last divergence word of a frame to its first depth, for any gaps."""
    columns, words, paths = config.columns, config.down_words, config.up_paths
    return [
        ("row_order", ROW_ORDER + LEAD),
        ("dst_forward, of the last row", forward_latency(columns, words)),
        ("elimination", elimination.LATENCY),
        ("frame_stack, turns the order of the rows", stack_latency(columns, words, paths)),
        ("substitution", substitution.LATENCY),
        ("dst_inverse, of the last two rows", inverse_latency(columns, paths)),
        ("corner_turn, waits for whole rows", corner_latency(columns, paths) - LEAD),
    ]
