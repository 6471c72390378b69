# SPDX-License-Identifier: Apache-2.0
"""The check of frames: no alarm on frames that are right, one on depths that are wrong, grids that have no time."""

from typing import Any

import numpy as np
import pytest

from tactile_depth.base.errors import InputError
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.cores import fastest
from tactile_depth.chip.poisson.divergence import divergence
from tactile_depth.chip.poisson.self_check import check_of
from tactile_depth.chip.tactile_depth import residuals, solve
from tb.settings import RUN

CHIP: dict[str, Any] = {
    "columns": 128,
    "rows": 96,
    "solver": "tridiagonal",
    "neumann": True,
    "data_width": 15,
    "coefficient_width": 10,
}
CASES: dict[str, dict[str, Any]] = {
    "chip": CHIP,
    "18 bits": {"columns": 64, "solver": "tridiagonal", "data_width": 18},
    "24 bits": {"columns": 64, "rows": 48, "solver": "tridiagonal", "lanes": 8, "neumann": True},
    "spectral, 15 bits": {"columns": 64, "data_width": 15},
    "spectral": {"columns": 32, "neumann": True},
}
CODES = 100_000_000 if RUN.full else 500_000  # depth codes without an alarm


def contacts(config: Configuration, count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return divergence and depth codes, (frames, rows, columns), of balls at random with noise; none clips."""
    chance, rows, columns = np.random.default_rng(seed), config.rows, config.columns
    y, x = np.indices((rows, columns)) + 0.5
    slopes = []
    for _ in range(count):
        height = np.zeros((rows, columns))
        for _ in range(chance.integers(4)):
            radius, depth = chance.uniform(0.05, 0.4) * rows, chance.uniform(0.1, 1)
            from_centre = np.hypot(y - chance.uniform(0, rows), x - chance.uniform(0, columns))
            height += depth * np.sqrt(np.maximum(radius**2 - from_centre**2, 0))
        steps = [np.diff(height, axis=axis, append=np.take(height, [-1], axis)) for axis in (1, 0)]
        noise = chance.normal(0, chance.choice([0, 0.002, 0.02, 0.2]), (rows, columns, 2))
        slopes.append(np.clip(np.stack(steps, axis=-1), -1, 1) * chance.uniform(0.05, 1) + noise)
    largest = (1 << config.gradient.width - 1) - 1
    codes = np.rint(np.stack(slopes) * config.gradient_limit / config.gradient_lsb).clip(-largest, largest)
    f = divergence(codes.astype(np.int64), config.neumann)
    z = solve(f, config, Monitor(), fastest())
    right = (np.abs(z) < (1 << config.depth.width - 1) - 1).all(axis=(-2, -1))
    return f[right], z[right]


@pytest.mark.parametrize("name", CASES)
def test_no_alarm_on_frames_that_are_right(name: str) -> None:
    config = Configuration(**CASES[name])
    bound, codes, seed = check_of(config).bound, 0, 0
    while codes < (CODES if name == "chip" else min(CODES, 5_000_000)):
        f, z = contacts(config, 40, seed)
        assert residuals(f, z, config).max() <= bound
        codes, seed = codes + z.size, seed + 1


@pytest.mark.parametrize("name", CASES)
def test_a_depth_that_is_wrong_by_more_than_the_bound_is_found(name: str) -> None:
    """Change one depth, in any row and column but the last, which the sums leave out."""
    config = Configuration(**CASES[name])
    check, chance = check_of(config), np.random.default_rng(2)
    f, z = contacts(config, 4, 3)
    for row in (0, 1, config.rows // 2, config.rows - 1):
        wrong = z.copy()
        column = chance.integers(config.columns - 1)
        wrong[:, row, column] += chance.choice([-1, 1]) * 4 * check.bound << check.dropped
        assert residuals(f, wrong, config).min() > check.bound


@pytest.mark.parametrize(
    "choices", [{"columns": 16}, {"columns": 32, "solver": "tridiagonal", "lanes": 8}], ids=["columns", "lanes"]
)
def test_a_grid_without_time_for_the_sums_is_refused(choices: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=r"32 columns or more, and 8 clocks .*set self_check=False"):
        Configuration(**choices, self_check=True)
