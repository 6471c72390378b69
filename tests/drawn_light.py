# SPDX-License-Identifier: Apache-2.0
"""Pictures of a sensor whose light is that of a calibration, drawn without contact and with a ball."""

import numpy as np
from PIL import Image

import tactile_depth as td

SIZE = (240, 320)


def light_of(sensor: td.Sensor) -> np.ndarray:
    """Return a smooth picture without contact, float64 (rows, columns, 3), in grey levels."""
    blocks = (90 * np.asarray(sensor.lighting)).astype(np.float32)
    return np.stack([np.asarray(Image.fromarray(each).resize(SIZE[::-1], Image.Resampling.BICUBIC)) for each in
                     np.moveaxis(blocks, -1, 0)], axis=-1).astype(np.float64)  # fmt: skip


def as_picture(levels: np.ndarray, seed: int = 1) -> np.ndarray:
    """Return a picture with a camera's noise of one grey level, uint8."""
    return np.clip(np.rint(levels + np.random.default_rng(seed).normal(size=levels.shape)), 0, 255).astype(np.uint8)


def no_contact(sensor: td.Sensor) -> np.ndarray:
    return as_picture(light_of(sensor))


def pressed(sensor: td.Sensor, row: float = 0.5, column: float = 0.45, radius_mm: float = 1.6) -> np.ndarray:
    """Return the levels of a picture with a ball of 6.31 mm, float64, by the middle coefficients of the calibration."""
    ball, pitch = 6.31 / 2, sensor.pixel_pitch_mm
    rows, columns = np.indices(SIZE)
    offset = np.stack((columns - column * SIZE[1], rows - row * SIZE[0]), axis=-1) * pitch
    distance = np.maximum(np.hypot(offset[..., 0], offset[..., 1]), 1e-9)
    nearest = np.minimum(distance, radius_mm)
    steepness = nearest / np.sqrt(ball**2 - nearest**2) * np.exp(-(distance - nearest) / 0.25)
    slopes = -(steepness / distance)[..., None] * offset
    coefficients = np.asarray(sensor.coefficients)[:, :, 0]
    return light_of(sensor) * (1 + slopes @ np.linalg.pinv(coefficients).T)
