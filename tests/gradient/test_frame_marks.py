# SPDX-License-Identifier: Apache-2.0
"""Model of frame_marks: the word of SLOPE_LIMIT against slopes of a calibration."""

from dataclasses import replace

import numpy as np
import pytest

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.gradient.frame_marks import NO_LIMIT, slope_limit, steep
from tactile_depth.sensor.synthetic import synthetic

CONFIG = Configuration(columns=16, gradient_model="lut")
UNIT = 1 << CONFIG.gradient.width - 9  # slope codes of a step of the word


@pytest.mark.parametrize("fitted", [0.0, 0.3, 0.5, 1.0, 5.0])
def test_no_slope_inside_the_range_is_steep_and_what_is_a_step_beyond_is(fitted: float) -> None:
    limit = slope_limit(replace(synthetic(4), fitted_slope={"lut": fitted}), CONFIG)
    most = int(min(fitted / CONFIG.gradient_lsb, (1 << CONFIG.gradient.width - 1) - 1))
    inside = np.array([[most, 0], [0, most], [-most, 0], [most, -most]])
    assert not steep(inside, limit, CONFIG).any()
    if limit < NO_LIMIT:
        beyond = np.array([[most + UNIT, 0], [0, most + UNIT], [-most - UNIT - 1, 0], [0, -most - UNIT - 1]])
        assert steep(beyond, limit, CONFIG).all()


def test_a_calibration_that_knows_no_range_has_no_limit() -> None:
    assert slope_limit(synthetic(4), CONFIG) == NO_LIMIT
