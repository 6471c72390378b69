# SPDX-License-Identifier: Apache-2.0
"""tridiagonal_solver: RTL against the model, the model against the double-precision reference."""

from typing import Any

import numpy as np
import pytest

from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.limits import most_lanes
from tactile_depth.chip.poisson.divergence import divergence
from tactile_depth.chip.poisson.tridiagonal_solver import tridiagonal_solver
from tactile_depth.chip.tactile_depth import solve
from tactile_depth.depth import reference
from tactile_depth.sensor.scenes import dome, slopes_of
from tb.poisson.tb_tridiagonal_solver import CHOICES

PEAKS = np.linspace(3, 18, 6) / 128  # of the domes, over N: those of the accuracy bar (3 to 18 pixels at 128)


def divergence_codes(slopes: np.ndarray, config: Configuration) -> tuple[Any, ...]:
    """Return slopes (..., rows, columns, 2) as divergence codes, and the divergence that the codes represent."""
    f = divergence(np.rint(slopes / config.gradient_lsb).astype(np.int64), config.neumann)
    return f, f * config.gradient_lsb


def error_percent(config: Configuration, slopes: np.ndarray) -> Any:
    f, exact = divergence_codes(slopes, config)
    monitor = Monitor()
    depth = solve(f, config, monitor) * config.depth_lsb_px
    assert not monitor.saturations
    want = reference.solve(exact, config.neumann)
    depth = depth[..., ::-1, :] if config.solver == "tridiagonal" else depth
    return 100 * np.sqrt(((depth - want) ** 2).mean(axis=(1, 2))) / want.max(axis=(1, 2))


# Bars: 0.005 % at 128 with 24-bit words; with 27 bits 0.001 % at 128, 0.01 % at 512; Neumann twice that.
@pytest.mark.parametrize("neumann", [False, True])
@pytest.mark.parametrize("solver", ["tridiagonal", "spectral"])
@pytest.mark.parametrize(("size", "data_width", "mean"), [(64, 24, 0.002), (128, 24, 0.005), (128, 27, 0.001)])
def test_depth_is_near_the_reference(size: int, data_width: int, mean: float, solver: str, neumann: bool) -> None:
    slopes = np.stack([slopes_of(dome(size, share * size)) for share in PEAKS])
    config = Configuration(columns=size, data_width=data_width, solver=solver, neumann=neumann)
    error, bound = error_percent(config, slopes), mean * (2 if neumann else 1)
    assert error.mean() < bound
    assert error.max() < 3 * bound


@pytest.mark.parametrize("neumann", [False, True])
@pytest.mark.parametrize(("columns", "rows"), [(16, 8), (64, 48), (64, 100), (256, 240)])
def test_rectangles(columns: int, rows: int, neumann: bool) -> None:
    config = Configuration(columns=columns, rows=rows, solver="tridiagonal", neumann=neumann)
    size = max(columns, rows)
    height = dome(2 * size, size / 16)[size - rows // 2 :, size - columns // 2 :][:rows, :columns]
    error = error_percent(config, slopes_of(height)[None])
    assert error.max() < 0.02


def test_neumann_has_zero_mean() -> None:
    config = Configuration(columns=32, rows=20, solver="tridiagonal", neumann=True)
    slopes = np.random.default_rng(1).uniform(-0.1, 0.1, (20, 32, 2))
    depth = tridiagonal_solver(divergence_codes(slopes, config)[0], config)
    assert abs(depth.mean() * config.depth_lsb_px) < 1e-4 * np.abs(depth).max() * config.depth_lsb_px


def test_zero_gives_zero() -> None:
    for neumann in (False, True):
        config = Configuration(**CHOICES, neumann=neumann)
        assert not np.any(tridiagonal_solver(np.zeros((8, 16), np.int64), config))


@pytest.mark.parametrize("neumann", [False, True])
@pytest.mark.parametrize(
    ("columns", "rows"), [(16, 8), (32, 9), (64, 96), (128, 127), (256, 20), (512, 17), (1024, 33)]
)
def test_all_numbers_of_depths_per_clock_give_the_same_codes(columns: int, rows: int, neumann: bool) -> None:
    slopes = np.random.default_rng(1).uniform(-0.1, 0.1, (2, rows, columns, 2))
    codes = []
    for log2 in range(most_lanes(columns).bit_length()):
        config = Configuration(columns=columns, rows=rows, solver="tridiagonal", neumann=neumann, lanes=1 << log2)
        codes.append(tridiagonal_solver(divergence_codes(slopes, config)[0], config))
    assert len(codes) >= 4
    assert all(np.array_equal(codes[0], other) for other in codes[1:])
