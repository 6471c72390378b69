# SPDX-License-Identifier: Apache-2.0
"""Bit-accurate model of hdl/tactile_depth.sv, RGB frames in, depth codes out, and its HDL parameters."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType

import numpy as np

from tactile_depth.base import files
from tactile_depth.base.errors import Argument, InputError
from tactile_depth.chip.calibration import Calibration
from tactile_depth.chip.camera.camera_unit import DEFAULT, camera_fields
from tactile_depth.chip.camera_configuration import CameraConfiguration
from tactile_depth.chip.common import td_node_map
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.contact.frame_flags import FrameFlags
from tactile_depth.chip.depth.zero_capture import LARGEST_LOG2
from tactile_depth.chip.depth.zero_offset import no_zero, zero_offset
from tactile_depth.chip.gradient.flat_field import (
    CODE,
    CODE_WIDTH,
    FLAT_CODE,
    PixelGains,
    flat_field_parameters,
    pixel_gains,
    reference_gains,
)
from tactile_depth.chip.gradient.frame_marks import MOST, NO_LIMIT, steep
from tactile_depth.chip.gradient.gradient_lookup import gradient_codes, gradient_lookup
from tactile_depth.chip.gradient.light_gains import Light, LightFilter
from tactile_depth.chip.gradient.polynomial_gradient import (
    coefficient_map,
    correction_entries,
    gradient_parameters,
    polynomial_gradient,
    polynomial_words,
)
from tactile_depth.chip.gradient.reference_capture import reference_capture_parameters
from tactile_depth.chip.latency import frame_latency
from tactile_depth.chip.limits import (
    COLOUR_COEFFICIENT,
    CORRECTION_BITS,
    CORRECTION_WIDTH,
    CUBIC,
    DARKEST_LOG2,
    DEVIATION,
    GUARD_BITS,
    LIGHT_GAIN,
    POLYNOMIAL,
    RATIO,
)
from tactile_depth.chip.poisson import spectral_solver, tridiagonal_solver
from tactile_depth.chip.poisson.cores import NUMPY, Cores
from tactile_depth.chip.poisson.divergence import divergence
from tactile_depth.chip.poisson.self_check import check_of, self_check
from tactile_depth.chip.registers.device_description import description_parameters
from tactile_depth.chip.registers.register_map import WORD_BITS
from tactile_depth.chip.registers.table_signatures import power_up_words
from tactile_depth.chip.rom_files import (
    write_crcs,
    write_gains,
    write_gradient,
    write_polynomials,
    write_solver,
    write_words,
    write_zero,
)
from tactile_depth.chip.table_entries import table_entries

CONSTANTS = {
    "GuardBits": (GUARD_BITS, "bits of the arithmetic below a stored word"),
    "PolynomialWords": (math.prod(CUBIC), "of the polynomial models: slopes, colours, terms"),
    "PolynomialWidth": (POLYNOMIAL.width, "bits of such a word"),
    "CorrectionWidth": (CORRECTION_WIDTH, "bits of a correction by colour"),
    "ColourCoeffWidth": (COLOUR_COEFFICIENT.width, "its upper bits, which are multiplied"),
    "DeviationWidth": (DEVIATION.width, "bits of a colour relative to the reference"),
    "DeviationFraction": (DEVIATION.fraction, "fraction bits of it"),
    "RatioWidth": (RATIO.width, "bits of a colour relative to the reference, before the light gains"),
    "RatioFraction": (RATIO.fraction, "fraction bits of it"),
    "LightGainWidth": (LIGHT_GAIN.width, "bits of a light gain, one bit less of them is fraction"),
    "CodeWidth": (CODE_WIDTH, "bits of a colour that indexes the gradient table"),
    "FlatCode": (FLAT_CODE, "code of a colour that equals the reference"),
    "DarkestLog2": (DARKEST_LOG2, "fraction bits of a gain beyond its width"),
    "ZeroLog2": (LARGEST_LOG2, "base-2 logarithm of the most frames in a capture of the zero offset"),
}
"""Numbers that both the models and the RTL use, and that no configuration changes, with their meaning."""
SIGNATURES = "signatures.hex"
"""File of the signatures of tables at power-up, for hdl/registers/table_signatures.sv."""
DERIVED = ("InWidth", "Width", "StoreDrop")
"""Parameters that hdl/poisson derives from fields."""


@dataclass(frozen=True)
class Tables:
    """Tables that turn the colours of every frame into slopes, computed once by `slope_tables`.

    Attributes
    ----------
    gains : PixelGains, or None without `flat_field`
    slopes : int64 array
        Model `lut`: slope codes by bin (bins, 2). Models of polynomials: coefficients (2, 3, rows, columns).
    corrections : int64 array (bins, 2), or None
        Model `cubic`: corrections by colour.
    """

    gains: PixelGains | None
    slopes: np.ndarray
    corrections: np.ndarray | None = None


def slope_tables(calibration: Calibration, config: Configuration, gains: np.ndarray | None = None) -> Tables:
    """Compute the tables of a calibration; for `gains` see `tactile_depth`."""
    calibration.check(config, gains is not None)
    if config.flat_field and gains is None:
        gains = reference_gains(calibration, config)
    if gains is not None:
        require_nodes(Argument("gains"), gains, (*config.reference_nodes, 3))
    if config.polynomials:
        slopes = coefficient_map(polynomial_words(calibration, config), config)
    else:
        slopes = gradient_codes(calibration, config)
    corrections = correction_entries(calibration, config)
    return Tables(None if gains is None else pixel_gains(gains, config), slopes, corrections)


def require_nodes(name: Argument, nodes: np.ndarray, shape: tuple[int, ...]) -> None:
    """Raise InputError unless words of the nodes have the shape of the grid of nodes."""
    if nodes.shape != shape:
        accepted = f"{shape}, a node for each block of the grid"
        raise InputError(name, f" have the shape {nodes.shape}", accepted=accepted)


def tactile_depth(
    frames: np.ndarray,
    calibration: Calibration,
    config: Configuration,
    monitor: Monitor | None = None,
    gains: np.ndarray | None = None,
    dark_level: int = 0,
    zero: np.ndarray | None = None,
    tables: Tables | None = None,
    light: np.ndarray | LightFilter | None = None,
) -> np.ndarray:
    """Return the depth codes of frames, rows in the order of the stream (tridiagonal solver: bottom row first).

    Parameters
    ----------
    frames : uint8 array (..., rows, columns, 3), RGB
    gains : int64 array (node rows, node columns, 3)
        Gains in use; by default those of the calibration's reference.
    dark_level : int
        Value of the register.
    zero : int64 array (node rows, node columns)
        Zero offset in use, for a configuration with `zero_offset`; by default nothing is subtracted.
    tables : Tables
        `slope_tables` of the same calibration, configuration and gains, for many calls; by default computed here.
    light : int64 array (..., 3) or LightFilter
        Light gains of each frame, or the filter of a stream, for a configuration with `light_gains`. By default a
        filter at reset, whose gains follow the light from frame to frame.

    Returns
    -------
    int64 array (..., rows, columns); depth_px = code * config.depth_lsb_px
    """
    tables = slope_tables(calibration, config, gains) if tables is None else tables
    slopes, _ = slopes_and_light(frames, config, tables, monitor, dark_level, light)
    return zeroed(solve(divergence(slopes, config.neumann), config, monitor), config, monitor, zero)


def zeroed(
    codes: np.ndarray, config: Configuration, monitor: Monitor | None = None, zero: np.ndarray | None = None
) -> np.ndarray:
    """Subtract the zero offset from depth codes (..., rows, columns) if the configuration has `zero_offset`."""
    if not config.zero_offset:
        return codes
    return zero_offset(codes, no_zero(config) if zero is None else zero, config, monitor)


def slopes_and_light(
    frames: np.ndarray,
    config: Configuration,
    tables: Tables,
    monitor: Monitor | None = None,
    dark_level: int = 0,
    light: np.ndarray | LightFilter | Callable[[np.ndarray, Light], np.ndarray] | None = None,
) -> tuple[np.ndarray, np.ndarray | None]:
    """Return slope codes, int64 (..., rows, columns, 2), and the light gains of each frame, None without them.

    `light` is that of `tactile_depth`, or the function of `Cores` that finds the gains of single pictures.
    """
    if tables.gains is not None:
        frames = tables.gains.colours(frames, dark_level, monitor)
    if not config.polynomials:
        return gradient_lookup(frames, tables.slopes, config.bits_per_channel), None
    if not config.light_gains:
        return polynomial_gradient(frames, tables.slopes, config, monitor, tables.corrections), None
    rule = Light.of(config)
    if callable(light):
        light = light(frames, rule)
    elif not isinstance(light, np.ndarray):
        light = (light or LightFilter(rule)).take_all(frames)
    deviation = rule.deviations(frames, light[..., None, None, :], monitor)
    return polynomial_gradient(deviation, tables.slopes, config, monitor, tables.corrections), light


def depth_and_flags(
    frame: np.ndarray,
    config: Configuration,
    tables: Tables,
    monitor: Monitor,
    *,
    dark_level: int = 0,
    zero: np.ndarray | None = None,
    light: np.ndarray | None = None,
    limit: int = NO_LIMIT,
    light_moves: bool = False,
    resumed: bool = False,
) -> tuple[np.ndarray, np.ndarray, FrameFlags]:
    """Return depth codes (rows, columns) of a frame, before and after the zero offset, and flags as if it were alone.

    For `dark_level` and `zero` see `tactile_depth`; `light` are the light gains (3,) of the frame, `limit` is the value
    of SLOPE_LIMIT.
    """
    own = Monitor()
    lights = None if light is None else light[None]
    slopes, _ = slopes_and_light(frame[None], config, tables, own, dark_level, lights)
    colours_clipped = own.saturations.total()
    divergences = divergence(slopes, config.neumann)
    depth = solve(divergences, config, own)
    depth_clipped = own.saturations.total()
    codes = zeroed(depth, config, own, zero)
    clipped = own.saturations.total()
    monitor.saturations += own.saturations
    dark = 0 if tables.gains is None else int(np.count_nonzero(tables.gains.dark(frame, dark_level)))
    red, green, blue = (0, 0, 0) if light is None else light.tolist()
    above = int(np.count_nonzero(steep(slopes, limit, config)))
    marks = colours_clipped > 0, depth_clipped > colours_clipped, clipped > depth_clipped, light_moves, resumed
    beyond = config.self_check and residuals(divergences, depth, config)[0] > check_of(config).bound
    flags = FrameFlags(*marks, residual=bool(beyond), light_gains=(red, green, blue))
    return depth[0], codes[0], flags._replace(dark=min(dark, MOST), steep=min(above, MOST))


def residuals(divergences: np.ndarray, depth: np.ndarray, config: Configuration) -> np.ndarray:
    """Return the residual of each frame, int64 (...), from its divergence and depth codes, (..., rows, columns)."""
    upright = depth[..., ::-1, :] if config.solver == "tridiagonal" else depth
    return self_check(divergences, upright, check_of(config))


def light_of(
    frames: np.ndarray,
    tables: Tables,
    config: Configuration,
    stream: LightFilter | None = None,
    cores: Cores = NUMPY,
) -> np.ndarray | None:
    """Return the light gains of frames, int64 (..., 3): of single pictures, or of a stream; None without them."""
    if not config.light_gains:
        return None
    assert tables.gains is not None
    relative = tables.gains.ratios(frames)
    return cores.settled(relative, Light.of(config)) if stream is None else stream.take_all(relative)


def solve(f: np.ndarray, config: Configuration, monitor: Monitor | None = None, cores: Cores = NUMPY) -> np.ndarray:
    """Return the depth codes of divergence codes (..., rows, columns) by the configuration's solver."""
    if config.solver == "tridiagonal":
        return tridiagonal_solver.tridiagonal_solver(f, config, monitor, cores)
    return spectral_solver.spectral_solver(f, config, monitor, cores)


def top_parameters(
    config: Configuration,
    pixel_pitch_mm: float = 0.0,
    camera: CameraConfiguration | None = None,
    tables_crc: int = 0,
) -> dict[str, int]:
    """Return the number of each field of Config, the parameter of hdl/tactile_depth.sv and hdl/tactile_sensor.sv.

    The fields of an option that the configuration leaves out have the numbers of a configuration with the option. The
    device tells its host the pitch of the grid, 0: unknown. A simulation takes the tables of `tables_crc`, which
    `write_roms` returns, and no others; with 0 those of any configuration that is written whole.
    """
    own = _own_parameters(config, pixel_pitch_mm) | camera_fields(camera)
    return default_parameters() | own | {"TablesCrc": tables_crc}


@cache
def default_parameters() -> MappingProxyType[str, int]:
    """Return the fields of the default configuration, in the order of the vector."""
    flat = [Configuration(flat_field=True, gradient_model=model) for model in ("cubic", "lut")]
    options = [*flat, Configuration(zero_offset=True), Configuration(solver="tridiagonal")]
    merged: dict[str, int] = {}
    for config in (*options, Configuration()):
        merged |= _own_parameters(config)
    return MappingProxyType(merged | camera_fields(DEFAULT) | camera_fields(None) | {"TablesCrc": 0})


def config_value(fields: Mapping[str, int]) -> str:
    """Return all fields as one number of SystemVerilog, 32 bits for each, the first in the lowest."""
    order = list(default_parameters())
    if fields.keys() != set(order):
        raise ValueError(f"not the fields of Config: {fields.keys() ^ set(order)}")
    words = sum((fields[name] & 0xFFFF_FFFF) << 32 * position for position, name in enumerate(order))
    return f"{32 * len(order)}'h{words:x}"


def hdl_parameters(
    config: Configuration,
    pixel_pitch_mm: float = 0.0,
    camera: CameraConfiguration | None = None,
    tables_crc: int = 0,
) -> dict[str, str]:
    """Return the parameters of hdl/tactile_depth.sv and hdl/tactile_sensor.sv, as the tools take them by name."""
    return {"Config": config_value(top_parameters(config, pixel_pitch_mm, camera, tables_crc))}


def _own_parameters(config: Configuration, pixel_pitch_mm: float = 0.0) -> dict[str, int]:
    """Return the fields that a configuration uses."""
    tridiagonal = config.solver == "tridiagonal"
    solver = tridiagonal_solver if tridiagonal else spectral_solver
    parameters = solver.solver_parameters(config)
    return {
        "Columns": config.columns,
        "Rows": config.rows,
        "Lanes": config.lanes,
        "Tridiagonal": int(tridiagonal),
        **{name: value for name, value in parameters.items() if name not in DERIVED},
        "BitsPerChannel": CORRECTION_BITS if config.gradient_model == "cubic" else config.bits_per_channel,
        "GradientWidth": config.gradient.width,
        "GradientFraction": config.gradient.fraction,
        "FrameLatency": frame_latency(config),
        **_colour_parameters(config),
        "ZeroOffset": int(config.zero_offset),
        "Parity": int(config.parity),
        **_check_parameters(config),
        **({"BlockLog2": config.reference_block_log2} if config.zero_offset else {}),
        **description_parameters(config, pixel_pitch_mm),
    }


def _check_parameters(config: Configuration) -> dict[str, int]:
    """Return the parameters of the check of frames, all 0 without it."""
    names = {"CheckDropped": "dropped", "CheckInDropped": "in_dropped", "CheckScale": "scale"}
    names |= {"CheckScaleFraction": "scale_fraction", "CheckSumWidth": "sum_width", "ResidualBound": "bound"}
    check = check_of(config) if config.self_check else None
    return {name: getattr(check, number, 0) for name, number in names.items()}


def _colour_parameters(config: Configuration) -> dict[str, int]:
    """Return the parameters of the cores from pixels to slopes."""
    polynomials = config.polynomials
    if not config.flat_field:
        return {"FlatField": 0, "Polynomial": 0, "Corrections": 0, "LightGains": 0}
    output = RATIO if config.light_gains else DEVIATION if polynomials else CODE
    flat, capture = flat_field_parameters(config, output), reference_capture_parameters(config)
    colour = {"FlatField": 1, "Polynomial": int(polynomials), "LightGains": int(config.light_gains)}
    colour["Corrections"] = int(config.gradient_model == "cubic")
    colour["BlockLog2"] = flat["BlockLog2"]
    colour |= {"ColourDrop": flat["Drop"], "GainWidth": flat["GainWidth"], "CaptureLog2": capture["MaxLog2"]}
    if polynomials:
        parameters = gradient_parameters(config)
        colour["SlopeDrop"] = parameters["Drop"]
        colour |= {name: parameters[name] for name in ("FineBits", "CorrectionUnit")}
    return colour


def write_roms(
    folder: Path,
    calibration: Calibration,
    config: Configuration,
    zero: np.ndarray | None = None,
    gains: np.ndarray | None = None,
) -> int:
    """Write every file that the RTL reads, and return the CRC-32 of the list that a simulation checks them by.

    For `zero` and `gains` see `tactile_depth`.

    Raises
    ------
    InputError
        The calibration and the configuration do not agree.
    """
    calibration.check(config, gains is not None)
    if gains is not None:
        require_nodes(Argument("gains"), gains, (*config.reference_nodes, 3))
    if zero is not None:
        require_nodes(Argument("zero"), zero, config.reference_nodes)
    with files.temporary(folder) as own:  # the folder may hold other tables
        write_solver(own, config)
        if config.zero_offset:
            side = td_node_map.side(config.lanes, config.reference_block_log2)
            zero_words = no_zero(config) if zero is None else zero
            write_zero(own, zero_words, config.depth.width, side, config.parity)
        if config.flat_field:
            gain_words = reference_gains(calibration, config) if gains is None else gains
            write_gains(own, gain_words, config.gain.width, config.parity)
        if config.polynomials:
            words = polynomial_words(calibration, config)
            write_polynomials(own, words, POLYNOMIAL.width, config.parity)
            corrections = correction_entries(calibration, config)
            if corrections is not None:
                write_gradient(own / "gradient.hex", corrections, CORRECTION_WIDTH, config.parity)
        else:
            codes = gradient_codes(calibration, config)
            write_gradient(own / "gradient.hex", codes, config.gradient.width, config.parity)
        entries = table_entries(calibration, config, zero, gains)
        write_words(own / SIGNATURES, power_up_words(entries), WORD_BITS)
        crc = write_crcs(own)
        for path in own.iterdir():
            path.replace(folder / path.name)
    return crc
