# SPDX-License-Identifier: Apache-2.0
"""gradient_lookup: RTL against the model, the model against the calibration of its table."""

from typing import Any

import numpy as np
import pytest

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.gradient_lookup import gradient_codes, gradient_lookup
from tactile_depth.depth import reference
from tactile_depth.sensor.sensor import Sensor
from tactile_depth.sensor.synthetic import synthetic


@pytest.mark.parametrize("bits", [1, 4, 6])
def test_codes_are_the_slopes_within_half_a_step(bits: int) -> None:
    """Use a random table, whose bins all differ, so that a wrong order of colours or bits is seen."""
    gradient = np.random.default_rng(bits).uniform(-0.9, 0.9, (*[1 << bits] * 3, 2))
    calibration = Sensor("random", gradient, 0.1)
    config = Configuration(columns=16, bits_per_channel=bits)
    frames = np.random.default_rng(1).integers(0, 256, (2, 16, 16, 3), dtype=np.uint8)
    codes = gradient_lookup(frames, gradient_codes(calibration, config), bits)
    assert codes.dtype == np.int64
    error = codes * config.gradient.lsb - reference.slopes(frames, calibration)
    assert np.abs(error).max() <= config.gradient.lsb / 2


@pytest.mark.parametrize("gradient_limit", [0.25, 1.0, 4.0])
def test_codes_of_slopes_up_to_the_limit_fit_their_width(gradient_limit: Any) -> None:
    largest = gradient_limit / (1 + 2.0**-8)  # what Sensor.gradient_limit leaves room for
    gradient = np.full((2, 2, 2, 2), largest)
    gradient[0] *= -1
    config = Configuration(columns=16, gradient_limit=gradient_limit, bits_per_channel=1)
    codes = gradient_codes(Sensor("full", gradient, 0.1), config)
    limit = 2 ** (config.gradient.width - 1)
    assert limit / 2 < codes.max() < limit
    assert codes.min() == -codes.max()


def test_a_gel_at_rest_has_slope_zero() -> None:
    config = Configuration(columns=16)
    flat = np.full((16, 16, 3), 128, np.uint8)
    assert not np.any(gradient_lookup(flat, gradient_codes(synthetic(), config), config.bits_per_channel))
