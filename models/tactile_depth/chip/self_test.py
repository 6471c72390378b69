# SPDX-License-Identifier: Apache-2.0
"""Signature that the self-test of a device shows: register SELF_TEST of docs/generated/registers.md."""

from __future__ import annotations

import numpy as np

from tactile_depth.chip.calibration import Calibration
from tactile_depth.chip.common.signature import signature
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.light_gains import Light
from tactile_depth.chip.poisson.divergence import divergence
from tactile_depth.chip.tactile_depth import Tables, slope_tables, slopes_and_light, solve, zeroed
from tactile_depth.chip.video.test_picture import picture


def self_test(
    config: Configuration,
    tables: Tables,
    zero: np.ndarray | None = None,
    dark_level: int = 0,
    light: np.ndarray | None = None,
) -> int:
    """Return the signature of the depth codes of the test picture.

    Parameters
    ----------
    tables : Tables
        `slope_tables` of the calibration and of the gains in use.
    zero, dark_level
        See `tactile_depth.chip.tactile_depth`.
    light : int64 array (3,)
        Light gains in use; by default 1, as after a reset.
    """
    frame = picture(config.rows, config.columns)
    gains = np.full(3, Light.of(config).unity) if light is None else light
    slopes, _ = slopes_and_light(frame[None], config, tables, None, dark_level, gains[None])
    codes = solve(divergence(slopes, config.neumann), config)
    return signature(zeroed(codes, config, None, zero).ravel().tolist())


def built_in(
    calibration: Calibration, config: Configuration, zero: np.ndarray | None = None, gains: np.ndarray | None = None
) -> int:
    """Return the signature of a device with the tables that `write_roms` writes."""
    return self_test(config, slope_tables(calibration, config, gains), zero)
