# SPDX-License-Identifier: Apache-2.0
"""The synthetic sensor, whose colours are linear in the slopes."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.limits import COEFFICIENTS, CUBIC
from tactile_depth.sensor.scenes import GAIN, LIGHTS, REST, SYNTHETIC_PIXEL_PITCH_MM
from tactile_depth.sensor.sensor import CORRECTIONS, LIGHTING_BLOCKS, Sensor

LARGEST_SLOPE = 0.99  # largest slope of the table, so that its gradient limit is 1


def synthetic(bits: int = 4) -> Sensor:
    """Return the synthetic sensor: the least-squares inverse of its colour model, as a table and as polynomials.

    The light is uniform and the colours are linear in the slopes, so only the first term of each polynomial is not 0.
    """
    step = 256 >> bits
    centre = np.arange(0, 256, step) + (step - 1) / 2
    colour = np.stack(np.meshgrid(centre, centre, centre, indexing="ij"), axis=-1)
    gradient = (colour - REST) / GAIN @ np.linalg.pinv(LIGHTS).T
    within = np.clip(gradient, -LARGEST_SLOPE, LARGEST_SLOPE)
    coefficients = np.zeros(COEFFICIENTS)
    coefficients[..., 0] = REST / GAIN * np.linalg.pinv(LIGHTS)
    cubic, corrections = np.zeros(CUBIC), np.zeros(CORRECTIONS)
    cubic[..., 0] = coefficients[..., 0]
    pitch = SYNTHETIC_PIXEL_PITCH_MM
    models = (within, pitch, coefficients, LARGEST_SLOPE)
    light = np.ones((*LIGHTING_BLOCKS, 3))
    return Sensor("synthetic", *models, cubic=cubic, corrections=corrections, lighting=light)


def synthetic_for(config: Configuration) -> Sensor:
    """Return the synthetic sensor with a table of the bits of a configuration."""
    return synthetic(config.bits_per_channel)
