# SPDX-License-Identifier: Apache-2.0
"""spectral_solver: RTL against the model, the model against the double-precision reference."""

from typing import Any

import numpy as np
import pytest

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.spectral_solver import spectral_solver
from tactile_depth.sensor.scenes import dome, slopes_of
from tests.poisson.test_tridiagonal_solver import PEAKS, error_percent


# Measured, mean and largest in %: 0.00025, 0.0005; 0.0010, 0.0022; 0.0026, 0.0072; 0.0036, 0.0071;
# 0.035, 0.085; 0.00036, 0.00076; 0.000010, 0.000021.
@pytest.mark.parametrize(
    ("size", "data_width", "coefficient_width", "mean", "largest"),
    [
        (16, 24, 18, 0.0003, 0.0006),
        (64, 24, 18, 0.0012, 0.0026),
        (128, 24, 18, 0.0031, 0.0087),
        (256, 24, 18, 0.0043, 0.0085),
        (128, 20, 18, 0.042, 0.1),
        (128, 27, 18, 0.00045, 0.0009),
        (128, 32, 24, 0.000012, 0.000025),
    ],
)
def test_depth_is_near_the_reference(
    size: int, data_width: int, coefficient_width: int, mean: bool, largest: int
) -> None:
    config = Configuration(columns=size, data_width=data_width, coefficient_width=coefficient_width)
    error = error_percent(config, np.stack([slopes_of(dome(size, share * size)) for share in PEAKS]))
    assert error.mean() < mean
    assert error.max() < largest


CONFIG = Configuration(columns=16)


def random_frame(seed: int) -> Any:
    """Return a random divergence whose depth stays within half of the range."""
    limit = 2.0 ** (CONFIG.divergence.width - 1) * 0.01
    return np.rint(np.random.default_rng(seed).uniform(-limit, limit, (16, 16))).astype(np.int64)


FRAMES = [random_frame(seed) for seed in range(30)]
LARGEST = 50  # codes; measured on 600 frames: 29 transposed, 0 turned, 34 of sums, 47 with f = g


@pytest.mark.parametrize(("f", "g"), zip(FRAMES, FRAMES[1:] + FRAMES[-1:], strict=True))
def test_a_turned_frame_and_a_sum_give_their_depth_within_rounding(f: Any, g: Any) -> None:
    z = spectral_solver(f, CONFIG)
    np.testing.assert_array_equal(spectral_solver(-f, CONFIG), -z)
    sums = spectral_solver(f + g, CONFIG) - spectral_solver(g, CONFIG)
    for other in (sums, spectral_solver(f.T, CONFIG).T, spectral_solver(f[::-1, ::-1], CONFIG)[::-1, ::-1]):
        assert np.abs(other - z).max() <= LARGEST
