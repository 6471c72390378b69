# SPDX-License-Identifier: Apache-2.0
"""wide_solver: RTL against the model; the model against the double-precision reference and against itself."""

import numpy as np
import pytest

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.tridiagonal_solver import tridiagonal_solver
from tactile_depth.chip.poisson.wide_solver import wide_solver
from tactile_depth.sensor.scenes import dome, slopes_of
from tb.poisson.tb_wide_solver import CHOICES
from tests.poisson.test_spectral_solver import PEAKS
from tests.poisson.test_tridiagonal_solver import divergence_codes, error_percent


@pytest.mark.parametrize("neumann", [False, True])
@pytest.mark.parametrize("rows", [8, 9, 96, 127])
def test_all_numbers_of_depths_per_clock_give_the_same_codes(rows: int, neumann: bool) -> None:
    codes = []
    for lanes in (2, 4, 8, 16, 32):
        config = Configuration(columns=64, rows=rows, solver="tridiagonal", neumann=neumann, lanes=lanes)
        slopes = np.random.default_rng(1).uniform(-0.1, 0.1, (2, rows, 64, 2))
        codes.append(wide_solver(divergence_codes(slopes, config)[0], config))
    assert all(np.array_equal(codes[0], other) for other in codes[1:])


# RMS errors of one depth per clock and of several: at most 1.05 times, over the domes of the bench of errors.
@pytest.mark.parametrize("neumann", [False, True])
@pytest.mark.parametrize("size", [64, 128])
def test_the_error_is_that_of_one_depth_per_clock(size: int, neumann: bool) -> None:
    slopes = np.stack([slopes_of(dome(size, share * size)) for share in PEAKS])
    one, wide = (
        error_percent(
            Configuration(columns=size, solver="tridiagonal", neumann=neumann, lanes=lanes), solver, slopes, True
        )
        for lanes, solver in ((1, tridiagonal_solver), (2, wide_solver))
    )
    assert wide.mean() < 1.2 * one.mean()


@pytest.mark.parametrize("neumann", [False, True])
def test_zero_gives_zero(neumann: bool) -> None:
    config = Configuration(**CHOICES, neumann=neumann, lanes=4)
    assert not np.any(wide_solver(np.zeros((8, 16), np.int64), config))
