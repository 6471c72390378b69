# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/tactile_depth.sv: RGB frames in, depth codes out; and its HDL parameters."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from models import spectral_solver, tridiagonal_solver
from models.auto_zero import auto_zero, no_floor
from models.calibration import COEFFICIENTS, Calibration
from models.configuration import POLYNOMIAL, Configuration
from models.divergence import divergence
from models.flat_field import deviations, flat_codes, flat_field_parameters, reference_gains
from models.floor_capture import floor_capture_parameters
from models.gradient_lookup import gradient_codes, gradient_lookup
from models.latency import frame_latency
from models.quadratic_gradient import gradient_parameters, polynomial_words, quadratic_gradient
from models.reference_capture import reference_capture_parameters
from models.rom_files import write_floor, write_gains, write_gradient, write_quadratic, write_solver
from models.round_saturate import Monitor


def tactile_depth(
    frames: np.ndarray,
    calibration: Calibration,
    config: Configuration,
    monitor: Monitor | None = None,
    gains: np.ndarray | None = None,
    dark_level: int = 0,
    floor: np.ndarray | None = None,
) -> np.ndarray:
    """Depth codes of frames, rows in the order of the stream: the tridiagonal solver puts the bottom row out first.

    Parameters
    ----------
    frames : uint8 array (..., rows, columns, 3), RGB
    gains : int64 array (node rows, node columns, 3)
        Those in use; by default of the calibration's reference.
    dark_level : int
        The register.
    floor : int64 array (node rows, node columns)
        That in use, of a configuration with `auto_zero`; by default nothing is subtracted.

    Returns
    -------
    int64 array (..., rows, columns); depth_px = code * config.depth_lsb_px
    """
    slopes = slope_codes(frames, calibration, config, monitor, gains, dark_level)
    return zeroed(solve(divergence(slopes, config.neumann), config, monitor), config, monitor, floor)


def zeroed(
    codes: np.ndarray, config: Configuration, monitor: Monitor | None = None, floor: np.ndarray | None = None
) -> np.ndarray:
    """Depth codes (..., rows, columns) less the floor, where the configuration has `auto_zero`."""
    if not config.auto_zero:
        return codes
    return auto_zero(codes, no_floor(config) if floor is None else floor, config, monitor)


def slope_codes(
    frames: np.ndarray,
    calibration: Calibration,
    config: Configuration,
    monitor: Monitor | None = None,
    gains: np.ndarray | None = None,
    dark_level: int = 0,
) -> np.ndarray:
    """Slope codes, int64 (..., rows, columns, 2), of frames: by the table or by quadratics, flat-fielded or as sent."""
    if config.flat_field and gains is None:
        gains = reference_gains(calibration, config)
    if config.gradient_model == "quadratic":
        assert gains is not None
        deviation = deviations(frames, gains, config, dark_level, monitor)
        return quadratic_gradient(
            deviation, polynomial_words(calibration, config, calibration.pixel_pitch_mm), config, monitor
        )
    if gains is not None:
        frames = flat_codes(frames, gains, config, dark_level, monitor)
    return gradient_lookup(frames, gradient_codes(calibration, config), config.bits_per_channel)


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
        **_colour_parameters(config),
        **_floor_parameters(config),
    }


def _colour_parameters(config: Configuration) -> dict[str, int]:
    """Of what stands between the pixels and their slopes."""
    quadratic = config.gradient_model == "quadratic"
    if not config.flat_field:
        return {"FlatField": 0, "Quadratic": 0}
    flat, capture = flat_field_parameters(config, quadratic), reference_capture_parameters(config)
    colour = {f"Colour{name}": flat[name] for name in ("Drop", "Offset", "Flat")}
    colour |= {"FlatField": 1, "Quadratic": int(quadratic), "BlockLog2": flat["BlockLog2"]}
    colour |= {"GainWidth": flat["GainWidth"], "GainFraction": capture["GainFraction"], "ColourWidth": flat["OutWidth"]}
    colour["CaptureLog2"] = capture["MaxLog2"]
    if quadratic:
        slope = gradient_parameters(config)
        colour |= {"PolynomialWords": math.prod(COEFFICIENTS), "PolynomialWidth": slope["WordWidth"]}
        colour |= {"ColourCoeffWidth": slope["CoeffWidth"], "SlopeDrop": slope["Drop"]}
    return colour


def _floor_parameters(config: Configuration) -> dict[str, int]:
    if not config.auto_zero:
        return {"AutoZero": 0}
    capture = floor_capture_parameters(config)
    return {"AutoZero": 1, "BlockLog2": capture["BlockLog2"], "FloorLog2": capture["MaxLog2"]}


def write_roms(folder: Path, calibration: Calibration, config: Configuration, floor: np.ndarray | None = None) -> None:
    """Every file that the RTL reads. `floor`: of `tactile_depth`."""
    write_solver(folder, config)
    if config.auto_zero:
        write_floor(folder, no_floor(config) if floor is None else floor, config.depth.width)
    if config.flat_field:
        write_gains(folder, reference_gains(calibration, config))
    if config.gradient_model == "quadratic":
        words = polynomial_words(calibration, config, calibration.pixel_pitch_mm)
        write_quadratic(folder, words, POLYNOMIAL.width)
    else:
        write_gradient(folder / "gradient.hex", gradient_codes(calibration, config), config.gradient.width)
