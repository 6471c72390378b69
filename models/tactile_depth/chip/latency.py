# SPDX-License-Identifier: Apache-2.0
"""Latency of the pipeline in cycles.

The latency of a core, from the first word of a burst in to the first word out, is `LATENCY` or `latency` of its model.
"""

from __future__ import annotations

from tactile_depth.chip.camera import camera_front_end
from tactile_depth.chip.camera_configuration import CameraConfiguration
from tactile_depth.chip.common import td_axis_skid
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.depth import zero_offset
from tactile_depth.chip.gradient import flat_field, gradient_lookup, light_gains, polynomial_gradient
from tactile_depth.chip.poisson import divergence, spectral_solver, tridiagonal_solver
from tactile_depth.chip.video import frame_guard


def by_core(config: Configuration) -> list[tuple[str, str, int]]:
    """Return unit, core and cycles on the way from the last pixel of a frame to its first depth, for any gaps.

    Cores beside the way, 0 cycles, are listed where they have memories or words of the way.
    """
    zero = zero_offset.latency(config.lanes, config.reference_block_log2)
    table = 0 if config.polynomials else gradient_lookup.LATENCY
    return [
        ("video_unit", "td_axis_skid", td_axis_skid.LATENCY),
        ("video_unit", "frame_guard", frame_guard.LATENCY),
        *[("gradient_unit", "flat_field", flat_field.LATENCY), ("gradient_unit", "reference_capture", 0)]
        * config.flat_field,
        *[("gradient_unit", "light_gains", light_gains.LATENCY)] * config.light_gains,
        *[("gradient_unit", "polynomial_gradient", polynomial_gradient.LATENCY)] * config.polynomials,
        *[("gradient_unit", "gradient_lookup", table)] * config.has_table,
        ("poisson_unit", "divergence", divergence.LATENCY),
        *(("poisson_unit", *step) for step in by_solver_core(config)),
        *[("poisson_unit", "self_check", 0)] * config.self_check,
        *[("depth_unit", "zero_offset", zero), ("depth_unit", "zero_capture", 0)] * config.zero_offset,
        ("contact_unit", "depth_gate", td_axis_skid.LATENCY),
        ("contact_unit", "contact_events", 0),
    ]


def by_solver_core(config: Configuration) -> list[tuple[str, int]]:
    """Return cores of the solver and cycles from the last divergence word of a frame to its first depth."""
    solver = tridiagonal_solver if config.solver == "tridiagonal" else spectral_solver
    return solver.latency_by_core(config)


def frame_latency(config: Configuration) -> int:
    """Return the cycles from the last pixel of a frame out of the guard to its first depth out of the solver."""
    return sum(cycles for unit, _, cycles in by_core(config) if unit in ("gradient_unit", "poisson_unit"))


def last_word_to_first_depth(camera: CameraConfiguration, config: Configuration) -> int:
    """Return the cycles from the camera's `last_word` to the first depth, for any gaps and blanking."""
    return camera_front_end.latency(camera) + last_pixel_to_first_depth(config)


def last_pixel_to_first_depth(config: Configuration) -> int:
    """Return the cycles of the pipeline from the last pixel of a frame to its first depth, for any gaps."""
    return sum(cycles for _, _, cycles in by_core(config))


def last_pixel_to_last_depth(config: Configuration) -> int:
    """Return the cycles of the pipeline from the last pixel of a frame to its last depth, for any gaps."""
    return last_pixel_to_first_depth(config) + beats(config) - 1


def beats(config: Configuration) -> int:
    """Return the clocks in which a frame of depth leaves."""
    return config.rows * config.columns // config.lanes


def first_depth_latency(config: Configuration) -> int:
    """Return the cycles of the pipeline from the first pixel of a frame without gaps to its first depth."""
    return config.rows * config.columns - 1 + last_pixel_to_first_depth(config)
