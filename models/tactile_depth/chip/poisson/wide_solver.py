# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/wide_solver.sv: divergence in, depth codes out, bottom row first.

All numbers of depth values per clock from 2 give the same codes.
"""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson import tridiagonal_solver, wide_elimination, wide_substitution
from tactile_depth.chip.poisson.cores import NUMPY, Cores
from tactile_depth.chip.poisson.frame_stack import frame_stack
from tactile_depth.chip.poisson.thomas_table import WideTable
from tactile_depth.chip.poisson.transform.wide_commutator import LEAD
from tactile_depth.chip.poisson.transform.wide_dst_forward import latency as forward_latency
from tactile_depth.chip.poisson.transform.wide_dst_inverse import latency as inverse_latency
from tactile_depth.chip.poisson.transform.wide_rows import LATENCY as WIDE_ROWS
from tactile_depth.chip.poisson.tridiagonal_solver import row_forward, row_inverse
from tactile_depth.chip.poisson.wide_stack import latency as stack_latency


def tables(config: Configuration) -> tuple[WideTable, WideTable]:
    """Return the tables of the coefficients down and up the rows."""
    return wide_elimination.table(config), wide_substitution.table(config)


def solver_parameters(config: Configuration) -> dict[str, int]:
    """Parameters of hdl/poisson/wide_solver.sv."""
    down, up = tables(config)
    return {
        **tridiagonal_solver.solver_parameters(config),
        "DownWords": config.down_words,
        "DownTableWords": len(down.words),
        "DownSettledWidth": down.settled_width,
        "UpTableWords": len(up.words),
        "UpSettledWidth": up.settled_width,
        "WordsPerRow": 1,
    }


def wide_solver(
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
    e = cores.wide_elimination(row_forward(f, config, monitor, cores), config, monitor)
    z = cores.wide_substitution(frame_stack(e), config, monitor)
    return row_inverse(z, config, monitor, cores)


def latency_by_core(columns: int, down_words: int, lanes: int) -> list[tuple[str, int]]:
    """Return cores and cycles from the last divergence word of a frame to its first depth, for any gaps."""
    return [
        ("wide_rows", WIDE_ROWS + LEAD),
        ("wide_dst_forward, of the last row", forward_latency(columns, down_words)),
        ("wide_elimination", wide_elimination.LATENCY),
        ("wide_stack, turns the order of the rows", stack_latency(columns, down_words, lanes)),
        ("wide_substitution", wide_substitution.LATENCY),
        ("wide_dst_inverse, of the first two rows out", inverse_latency(columns, lanes) - LEAD),
    ]
