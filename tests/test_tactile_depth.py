# SPDX-License-Identifier: Apache-2.0
"""tactile_depth: RTL against the models, at its pins."""

from collections.abc import Callable

import pytest

from tactile_depth.chip.resources import ULTRA
from tb.settings import RUN
from tb.structures import Structure
from tb.tactile_depth.settings import FORMATS, SMALLEST, TRIDIAGONAL, WHOLE, built
from tb.tactile_depth.settings import STRUCTURES as STRUCTURES


def level_of(structure: Structure, simulator: str) -> str:
    """Return the last level of a run of a structure.

    `make test` runs every test on the tridiagonal solver, and each pair of gaps and stalls on one of the solvers; a
    build of several lanes on Icarus up to the streams, because Verilator runs the others. `make regress` runs the rest
    on Verilator.
    """
    choices = structure.device["configuration"]
    if structure.level == WHOLE and "solver" not in choices:
        return WHOLE if RUN.full and simulator == "verilator" else "disturbed"
    if "lanes" in choices and simulator == "icarus":
        return "stream"
    return structure.level


@pytest.mark.long
@pytest.mark.seeds
def test_rtl(run_tb: Callable[..., None], simulator: str, structure: Structure) -> None:
    run_tb(structure, level=level_of(structure, simulator))


@pytest.mark.parametrize("simulator", ["icarus"], indirect=True)
def test_words_side_by_side_in_the_frame_store(run_tb: Callable[..., None], simulator: str) -> None:
    """Run the frame store with several words per memory row, as on grids that are too large for this testbench."""
    choices = TRIDIAGONAL | {"columns": 32, "bits_per_channel": 2}
    level = "stream" if RUN.full else "first"
    run_tb(built("packed", choices, level, {"WordsPerRow": 3, "StoreStyle": ULTRA}))


@pytest.mark.long
@pytest.mark.seeds
@pytest.mark.structures([SMALLEST])
def test_a_second_client(run_tb: Callable[..., None], structure: Structure) -> None:
    """Run the tests that send whole rows through cocotbext-axi; `make test` plays them up to the level formats."""
    run_tb(structure, second_client=True, level=WHOLE if RUN.full else FORMATS)
