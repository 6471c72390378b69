# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/poisson/spectral_solver.sv: divergence in, depth codes out."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.cores import NUMPY, Cores
from tactile_depth.chip.poisson.spectral_divide import LATENCY as SPECTRAL_DIVIDE
from tactile_depth.chip.poisson.spectral_divide import reciprocals, spectral_divide
from tactile_depth.chip.poisson.transform.commutator import LEAD
from tactile_depth.chip.poisson.transform.corner_turn import corner_turn
from tactile_depth.chip.poisson.transform.corner_turn import latency as corner_latency
from tactile_depth.chip.poisson.transform.dst_forward import latency as forward_latency
from tactile_depth.chip.poisson.transform.dst_inverse import latency as inverse_latency
from tactile_depth.chip.poisson.transform.row_order import LATENCY as ROW_ORDER
from tactile_depth.chip.poisson.transform.row_order import row_order
from tactile_depth.chip.poisson.transform.transpose import LATENCY as TRANSPOSE
from tactile_depth.chip.poisson.transform.transpose import transpose


def solver_parameters(config: Configuration) -> dict[str, int]:
    """Parameters of hdl/poisson/spectral_solver.sv."""
    table = reciprocals(config)
    return {
        **config.solver_parameters(),
        "RowForwardOut": config.row_forward.fraction - config.row_modes.fraction,
        "ColumnForwardIn": config.row_modes.fraction - config.column_forward.fraction,
        "ColumnInverseOut": config.column_inverse.fraction - config.depth_modes.fraction,
        "RowInverseIn": config.depth_modes.fraction - config.row_inverse.fraction,
        "RowInverseOut": config.row_inverse.fraction - config.depth.fraction,
        "StoreStyle": config.store_style,
        "DivideShiftWidth": table.shift_width,
        "DivideDrop": table.drop,
        "Neumann": int(config.neumann),
    }


def spectral_solver(
    f: np.ndarray, config: Configuration, monitor: Monitor | None = None, cores: Cores = NUMPY
) -> np.ndarray:
    """Solve the Poisson equation for frames of divergence codes.

    Parameters
    ----------
    f : int64 array (..., N, N), codes of `config.divergence`

    Returns
    -------
    int64 array (..., N, N), codes of `config.depth`; depth_px = code * config.depth_lsb_px
    """
    modes = row_forward(f, config, monitor, cores)
    modes = column_forward(
        transpose(modes, makhoul_in=False, makhoul_out=True), config, monitor, cores
    )  # bursts are columns now
    modes = spectral_divide(modes, config, monitor)
    modes = column_inverse(modes, config, monitor, cores)
    return row_inverse(
        transpose(modes, makhoul_in=True, makhoul_out=False), config, monitor, cores
    )  # bursts are rows again


# The four transforms. Each takes bursts (..., N).


def row_forward(
    rows: np.ndarray, config: Configuration, monitor: Monitor | None = None, cores: Cores = NUMPY
) -> np.ndarray:
    """Return the modes of rows in natural order, for the first frame store."""
    formats = config.transform(config.divergence, config.row_forward, config.row_modes)
    return cores.dst_forward(row_order(rows), formats, monitor, "row_forward")


def column_forward(
    columns: np.ndarray, config: Configuration, monitor: Monitor | None = None, cores: Cores = NUMPY
) -> np.ndarray:
    """Return the modes of columns in Makhoul order."""
    formats = config.transform(config.row_modes, config.column_forward, config.column_forward)
    return cores.dst_forward(columns, formats, monitor, "column_forward")


def column_inverse(
    modes: np.ndarray, config: Configuration, monitor: Monitor | None = None, cores: Cores = NUMPY
) -> np.ndarray:
    """Return columns in Makhoul order from their modes, for the second frame store."""
    formats = config.transform(config.column_inverse, config.column_inverse, config.depth_modes)
    return cores.dst_inverse(modes, formats, monitor, "column_inverse")


def row_inverse(
    modes: np.ndarray, config: Configuration, monitor: Monitor | None = None, cores: Cores = NUMPY
) -> np.ndarray:
    """Return rows of depth in natural order from their modes."""
    formats = config.transform(config.depth_modes, config.row_inverse, config.depth)
    depth = cores.dst_inverse(modes, formats, monitor, "row_inverse")
    return corner_turn(depth)


def latency_by_core(config: Configuration) -> list[tuple[str, int]]:
    """Return cores and cycles from the last divergence word of a frame to its first depth, for any gaps."""
    size = config.columns
    forward, inverse = forward_latency(size, 1), inverse_latency(size, 1)
    return [
        ("row_order", ROW_ORDER + LEAD),
        ("dst_forward, of the last row", forward),
        ("transpose, to columns", TRANSPOSE),
        ("dst_forward, of a column", forward),
        ("spectral_divide", SPECTRAL_DIVIDE),
        ("dst_inverse, of a column", inverse),
        # The last column comes size - 1 bursts after the first and is the last row of the second transpose.
        ("all other columns", size * (size - 1)),
        ("transpose, to rows", TRANSPOSE),
        ("dst_inverse, of the first row out", inverse),
        ("corner_turn, waits for the whole row", corner_latency(size, 1) - LEAD),
    ]
