# SPDX-License-Identifier: Apache-2.0
"""tactile_depth: RTL against the models, at its pins."""

import json
from collections.abc import Callable
from itertools import product
from typing import Any

import pytest

from tactile_depth.configuration import COLUMNS, ULTRA, Configuration
from tactile_depth.sensor import synthetic
from tactile_depth.tactile_depth import top_parameters, write_roms
from tb.stream import REGRESS
from tests.attack import PROFILES

# Tests for formats other than the first of each solver, and for a larger grid.
FORMATS = (
    "configuration|back_to_back|contact.*=none|every_fault|saturation|"
    "gaps_and_stalls/offers=random/accepts=(one_in_4|random)"
)
FLAT = f"{FORMATS}|capture|floor|dark_pixels|depth_frames|resets.*=2.*full"
# `make test` runs EVERY test on the tridiagonal solver, FORMATS on the spectral one, and each pair of gaps and stalls
# on one of them. `make regress` runs all on both, but on Icarus for the spectral solver.
PAIRS = {
    solver: "|".join(
        f"gaps_and_stalls/offers={gap}/accepts={stall}$"
        for (m, gap), (n, stall) in product(enumerate(PROFILES), enumerate(PROFILES))
        if (m + n) % 2 == odd
    )
    for odd, solver in enumerate(COLUMNS)
}
# Long tests. With a sink that never waits they run in `make regress` alone, on Verilator with the tridiagonal solver.
LONG = "(malformed|random_streams|gradient_table_rewritten|registers_written_in).*accepts=none"
# Tests that repeat for each disturbance.
REPEATED = f"gaps_and_stalls|records_at_the_limits|{LONG}|random_streams|side_by_side|every_fault_in_a_row/.*random"
EVERY = f"^(?!.*(gaps_and_stalls|{LONG}|side_by_side/fault=[0-3]))"
# Tests in which the solver does not matter.
OF_ONE = "registers_written_in_every|committed_at_the_first|table_rewritten"
SPECTRAL = f"^(?!.*({REPEATED}|{OF_ONE}))"
DISTURBED = "gaps_and_stalls/offers=random/accepts=random"
# A shorter choice for other formats on Icarus.
FIRST_OF_THEM = ("every_fault", "every_fault_in_a_row/accepts=none")
PACKED = "back_to_back"
LARGER = "configuration|back_to_back|resets.*=2.*full|gaps_and_stalls/offers=random/accepts=random"
LARGER_SLOW = "configuration|back_to_back"

# Through the second client: here, and in `make regress`.
SECOND_QUICK = (
    "configuration|one_frame|gaps_and_stalls/offers=random/accepts=random|waits_for_long|contact/accepts=none|"
    "malformed.*random|in_a_row/accepts=random|silence|registers_written_(all|phase)"
)
SECOND = (
    "configuration|one_frame|gaps_and_stalls/offers=random|waits_for_long|contact|malformed|in_a_row|silence|"
    "registers_written"
)
TRIDIAGONAL: dict[str, Any] = {"columns": 16, "rows": 8, "solver": "tridiagonal"}
FLAT_QUADRATIC: dict[str, Any] = {"flat_field": True, "gradient_model": "quadratic"}
STRUCTURES: dict[str, Any] = {  # choices of the configuration, and which tests run ("": every test)
    "16-24": ({"columns": 16, "bits_per_channel": 2}, ""),
    "16-27-neumann": ({"columns": 16, "data_width": 27, "neumann": True}, FORMATS),
    "32-12": ({"columns": 32, "data_width": 12, "bits_per_channel": 3}, LARGER),
    "tridiagonal-8x16": (TRIDIAGONAL | {"bits_per_channel": 2}, ""),
    "tridiagonal-21x16-neumann": (TRIDIAGONAL | {"rows": 21, "data_width": 27, "neumann": True}, FORMATS),
    "tridiagonal-8x16-quadratic": (TRIDIAGONAL | FLAT_QUADRATIC, FLAT),
    "16-flat-neumann": ({"columns": 16, "flat_field": True, "neumann": True, "auto_zero": True}, FLAT),
    "tridiagonal-8x16-zero": (TRIDIAGONAL | {"bits_per_channel": 2, "neumann": True, "auto_zero": True}, FLAT),
}


@pytest.mark.seeds
@pytest.mark.structures(
    "name",
    verilator=[("tridiagonal-8x16-quadratic",), ("tridiagonal-8x16",), ("16-24",)],
    icarus=[("tridiagonal-8x16-zero",)],
    regress=[
        ("32-12",),
        ("tridiagonal-8x16-quadratic",),
        ("tridiagonal-8x16",),
        ("16-24",),
        ("16-flat-neumann",),
        ("16-27-neumann",),
        ("tridiagonal-21x16-neumann",),
    ],
    regress_verilator=[
        ("tridiagonal-8x16-zero",),
        ("16-flat-neumann",),
        ("16-27-neumann",),
        ("32-12",),
        ("tridiagonal-21x16-neumann",),
    ],
)
def test_rtl(run_tb: Callable[..., None], simulator: str, name: str) -> None:
    choices, tests = STRUCTURES[name]
    config = Configuration(**choices)
    spectral, slow = config.solver == "spectral", simulator == "icarus"
    if not REGRESS:
        if not tests:
            tests = f"{FORMATS if spectral else EVERY}|{PAIRS[config.solver]}"
        elif slow:
            tests = LARGER_SLOW if tests == LARGER else tests.replace(*FIRST_OF_THEM)
    elif slow and spectral and not tests:
        tests = f"{SPECTRAL}|{DISTURBED}"
    run_tb(
        "tactile_depth",
        None,
        top_parameters(config),
        roms=lambda folder: write_roms(folder, synthetic(config.bits_per_channel), config),
        environment={"COCOTB_TEST_FILTER": tests, "CONFIGURATION": json.dumps(choices)},
    )


@pytest.mark.parametrize("simulator", ["icarus"], indirect=True)
def test_words_side_by_side_in_the_frame_store(run_tb: Callable[..., None], simulator: str) -> None:
    """Run the frame store as on grids too large for the tests of each beat."""
    choices: dict[str, Any] = {"columns": 32, "solver": "tridiagonal", "bits_per_channel": 2}
    config = Configuration(**choices)
    run_tb(
        "tactile_depth",
        None,
        top_parameters(config) | {"WordsPerRow": 3, "StoreStyle": ULTRA},
        roms=lambda folder: write_roms(folder, synthetic(config.bits_per_channel), config),
        environment={"COCOTB_TEST_FILTER": PACKED, "CONFIGURATION": json.dumps(choices)},
    )


@pytest.mark.seeds
@pytest.mark.structures("name", verilator=[("tridiagonal-8x16",)], regress=[("tridiagonal-8x16",)])
def test_a_second_client(run_tb: Callable[..., None], name: str) -> None:
    """The same tests through cocotbext-axi, but for those that break a stream off in mid row."""
    choices, _ = STRUCTURES[name]
    config = Configuration(**choices)
    run_tb(
        "tactile_depth",
        None,
        top_parameters(config),
        roms=lambda folder: write_roms(folder, synthetic(config.bits_per_channel), config),
        environment={
            "COCOTB_TEST_FILTER": SECOND if REGRESS else SECOND_QUICK,
            "CONFIGURATION": json.dumps(choices),
            "CLIENT": "second",
        },
    )
