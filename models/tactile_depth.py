# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/tactile_depth.sv: RGB frames in, depth codes out; and its HDL parameters."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from models import spectral_solver, tridiagonal_solver
from models.calibration import Calibration
from models.configuration import Configuration
from models.divergence import divergence
from models.gradient_lookup import gradient_codes, gradient_lookup
from models.latency import frame_latency
from models.rom_files import write_gains, write_gradient, write_solver
from models.round_saturate import Monitor


def tactile_depth(
    frames: np.ndarray, calibration: Calibration, config: Configuration, monitor: Monitor | None = None
) -> np.ndarray:
    """Depth codes of frames, rows in the order of the stream: the tridiagonal solver puts the bottom row out first.

    Parameters
    ----------
    frames : uint8 array (..., rows, columns, 3), RGB

    Returns
    -------
    int64 array (..., rows, columns); depth_px = code * config.depth_lsb_px
    """
    slopes = gradient_lookup(frames, gradient_codes(calibration, config), config.bits_per_channel)
    return solve(divergence(slopes, config.neumann), config, monitor)


def solve(f: np.ndarray, config: Configuration, monitor: Monitor | None = None) -> np.ndarray:
    """Depth codes of divergence codes (..., rows, columns), by the configuration's solver."""
    if config.solver == "tridiagonal":
        return tridiagonal_solver.tridiagonal_solver(f, config, monitor)
    return spectral_solver.spectral_solver(f, config, monitor)


def top_parameters(config: Configuration) -> dict[str, int]:
    """Parameters of hdl/tactile_depth.sv."""
    tridiagonal = config.solver == "tridiagonal"
    solver = tridiagonal_solver if tridiagonal else spectral_solver
    parameters = solver.solver_parameters(config)
    del parameters["InWidth"]
    return {
        **parameters,
        "Rows": config.rows,
        "Tridiagonal": int(tridiagonal),
        "BitsPerChannel": config.bits_per_channel,
        "GradientWidth": config.gradient.width,
        "GradientFraction": config.gradient.fraction,
        "FrameLatency": frame_latency(config),
    }


def write_roms(folder: Path, calibration: Calibration, config: Configuration) -> None:
    """Every file that the RTL reads."""
    write_solver(folder, config)
    write_gradient(folder / "gradient.hex", gradient_codes(calibration, config), config.gradient.width)
    write_gains(folder / "gain.hex", config)
