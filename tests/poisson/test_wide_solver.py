# SPDX-License-Identifier: Apache-2.0
"""wide_solver: RTL against the model; the model against the double-precision reference and against itself."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.tridiagonal_solver import tridiagonal_solver
from tactile_depth.chip.poisson.wide_solver import wide_solver
from tactile_depth.chip.rom_files import write_solver
from tactile_depth.chip.tactile_depth import config_value, top_parameters
from tactile_depth.sensor.scenes import dome, slopes_of
from tb.structures import BOTH, ICARUS, QUICK_FIRST, VERILATOR, Mutants, Structure
from tests.poisson.test_spectral_solver import PEAKS
from tests.poisson.test_tridiagonal_solver import divergence_codes, error_percent

CHOICES: dict[str, Any] = {"columns": 16, "rows": 8, "solver": "tridiagonal"}


def built(choices: Any, **runs: Any) -> Structure:
    config = Configuration(**choices)
    return Structure(
        {"Config": config_value(top_parameters(config))},
        device={"configuration": choices},
        roms=lambda folder: write_solver(folder, config),
        **runs,
    )


STRUCTURES = (
    built(CHOICES | {"columns": 32, "rows": 11, "lanes": 8}, on=VERILATOR),
    built(CHOICES | {"columns": 64, "rows": 8, "lanes": 32}, late=BOTH),
    built(CHOICES | {"lanes": 8, "rows": 9, "neumann": True}, on=ICARUS),
    built(CHOICES | {"lanes": 2, "rows": 9}, on=ICARUS, mutants=True),
    built(CHOICES | {"columns": 32, "rows": 9, "lanes": 4, "data_width": 16, "coefficient_width": 10}, mutants=True),
    built(CHOICES | {"columns": 32, "rows": 8, "lanes": 16, "data_width": 32, "coefficient_width": 24}),
    built(CHOICES | {"columns": 64, "rows": 96, "lanes": 16, "neumann": True}),
    built(CHOICES | {"columns": 128, "rows": 13, "lanes": 64}),
)
MUTANTS = Mutants("words", simulators=QUICK_FIRST, flat=False)
NO_PROOF = "a chain of proven cores, each of which takes what the one before it sends; no control of its own"


@pytest.mark.seeds
def test_rtl(run_tb: Callable[..., None], structure: Structure) -> None:
    run_tb(structure)


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
