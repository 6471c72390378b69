# SPDX-License-Identifier: Apache-2.0
"""spectral_solver: RTL against the model, the model against the double-precision reference."""

from typing import Any

import numpy as np
import pytest

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.divergence import divergence
from tactile_depth.chip.poisson.spectral_solver import spectral_solver
from tactile_depth.depth import reference
from tactile_depth.sensor.scenes import dome, slopes_of

PEAKS = np.linspace(3, 18, 6) / 128  # of the domes, over N: those of the accuracy bar (3 to 18 pixels at 128)


def error_percent(config: Configuration) -> Any:
    """Return the RMS error of the depth of each dome in % of its peak; the reference gets the same slope codes."""
    slopes = np.stack([slopes_of(dome(config.columns, share * config.columns)) for share in PEAKS])
    f = divergence(np.rint(slopes / config.gradient.lsb).astype(np.int64))
    monitor = Monitor()
    depth = spectral_solver(f, config, monitor) * config.depth_lsb_px
    assert not monitor.saturations
    want = reference.solve(f * config.divergence.lsb)
    return 100 * np.sqrt(((depth - want) ** 2).mean(axis=(1, 2))) / want.max(axis=(1, 2))


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
    error = error_percent(config)
    assert error.mean() < mean
    assert error.max() < largest


CONFIG = Configuration(columns=16)


def random_frame(seed: int) -> Any:
    """Return a random divergence whose depth stays within half of the range."""
    limit = 2.0 ** (CONFIG.divergence.width - 1) * 0.01
    return np.rint(np.random.default_rng(seed).uniform(-limit, limit, (16, 16))).astype(np.int64)


FRAMES = [random_frame(seed) for seed in range(30)]
LARGEST = 50  # codes; measured on 600 frames: 29 transposed, 0 turned, 34 of sums, 47 with f = g


@pytest.mark.parametrize("f", FRAMES)
def test_negation_goes_through(f: Any) -> None:
    np.testing.assert_array_equal(spectral_solver(-f, CONFIG), -spectral_solver(f, CONFIG))


@pytest.mark.parametrize("f", FRAMES)
def test_a_transposed_or_turned_frame_gives_its_depth_within_rounding(f: Any) -> None:
    z = spectral_solver(f, CONFIG)
    assert np.abs(spectral_solver(f.T, CONFIG) - z.T).max() <= LARGEST
    assert np.abs(spectral_solver(f[::-1, ::-1], CONFIG) - z[::-1, ::-1]).max() <= LARGEST


@pytest.mark.parametrize(("f", "g"), zip(FRAMES, FRAMES[1:] + FRAMES[-1:], strict=True))
def test_sums_go_through_within_rounding(f: Any, g: Any) -> None:
    error = spectral_solver(f + g, CONFIG) - spectral_solver(f, CONFIG) - spectral_solver(g, CONFIG)
    assert np.abs(error).max() <= LARGEST
