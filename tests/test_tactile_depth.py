# SPDX-License-Identifier: Apache-2.0
"""tactile_depth: RTL against the models, at its pins."""

import json
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

import pytest

from tactile_depth.built_in import synthetic
from tactile_depth.configuration import ULTRA, Configuration
from tactile_depth.tactile_depth import config_value, top_parameters, write_roms
from tb.stream import REGRESS

ALL: dict[str, str] = {}  # every test, up to the level of the run
FORMATS = {"LEVEL": "formats"}  # tests that depend on formats and options of a build
TRIDIAGONAL: dict[str, Any] = {"columns": 16, "rows": 8, "solver": "tridiagonal"}
FLAT_QUADRATIC: dict[str, Any] = {"flat_field": True, "gradient_model": "quadratic"}
# Choices of the configuration, and the last level of its tests.
STRUCTURES: dict[str, tuple[dict[str, Any], dict[str, str]]] = {
    "16-24": ({"columns": 16, "bits_per_channel": 2}, ALL),
    "16-27-neumann": ({"columns": 16, "data_width": 27, "neumann": True}, FORMATS),
    "32-12": ({"columns": 32, "data_width": 12, "bits_per_channel": 3}, {"LEVEL": "stream"}),
    "tridiagonal-8x16": (TRIDIAGONAL | {"bits_per_channel": 2}, ALL),
    "tridiagonal-21x16-neumann": (TRIDIAGONAL | {"rows": 21, "data_width": 27, "neumann": True}, FORMATS),
    "tridiagonal-9x32-4-lanes": (TRIDIAGONAL | {"columns": 32, "rows": 9, "lanes": 4, "bits_per_channel": 2}, FORMATS),
    "tridiagonal-8x16-2-lanes": (TRIDIAGONAL | {"lanes": 2, "bits_per_channel": 2, "neumann": True}, FORMATS),
    "tridiagonal-9x32-4-lanes-sensor": (
        TRIDIAGONAL | FLAT_QUADRATIC | {"columns": 32, "rows": 9, "lanes": 4, "neumann": True, "zero_offset": True},
        FORMATS,
    ),
    "tridiagonal-9x16-4-lanes-sensor": (
        TRIDIAGONAL | FLAT_QUADRATIC | {"rows": 9, "lanes": 4, "neumann": True, "zero_offset": True},
        FORMATS,
    ),
    "tridiagonal-21x16-2-lanes-zero": (
        TRIDIAGONAL | {"rows": 21, "lanes": 2, "bits_per_channel": 2, "zero_offset": True},
        FORMATS,
    ),
    "tridiagonal-8x16-quadratic": (TRIDIAGONAL | FLAT_QUADRATIC | {"gain_width": 17}, FORMATS),
    "16-flat-neumann": ({"columns": 16, "flat_field": True, "neumann": True, "zero_offset": True}, FORMATS),
    "tridiagonal-8x16-zero": (TRIDIAGONAL | {"bits_per_channel": 2, "neumann": True, "zero_offset": True}, FORMATS),
}
# `make test` runs every test on the tridiagonal solver, and each pair of gaps and stalls on one of the solvers.
# `make regress` runs each test of the spectral solver on Icarus under one disturbance only.
SPECTRAL = {"LEVEL": "disturbed"}
SPECTRAL_ON_ICARUS = {"LEVEL": "whole"}
LANES_ON_ICARUS = {"LEVEL": "stream"}  # in `make test`: the other tests of that build run on Verilator
IN_ANY_ORDER = {"COCOTB_RANDOM_TEST_ORDER": "1"}  # of the tests of a level: no test depends on an earlier one


def run(
    run_tb: Callable[..., None],
    choices: dict[str, Any],
    environment: Mapping[str, str],
    parameters: Mapping[str, int] = MappingProxyType({}),
) -> None:
    """Build the pipeline of a configuration, with some parameters in place of its own, and run its testbench."""
    config = Configuration(**choices)
    run_tb(
        "tactile_depth",
        {"Config": config_value({**top_parameters(config), **parameters})},
        roms=lambda folder: write_roms(folder, synthetic(config.bits_per_channel), config),
        environment={
            "CONFIGURATION": json.dumps(choices),
            "PARAMETERS": json.dumps(dict(parameters)),
            **IN_ANY_ORDER,
            **environment,
        },
    )


@pytest.mark.seeds
@pytest.mark.structures(
    "name",
    verilator=[
        ("tridiagonal-8x16-quadratic",),
        ("tridiagonal-8x16",),
        ("16-24",),
        ("tridiagonal-9x32-4-lanes-sensor",),
    ],
    icarus=[("tridiagonal-8x16-zero",), ("tridiagonal-9x32-4-lanes-sensor",)],
    regress=[
        ("32-12",),
        ("tridiagonal-8x16-quadratic",),
        ("tridiagonal-8x16",),
        ("16-24",),
        ("16-flat-neumann",),
        ("16-27-neumann",),
        ("tridiagonal-21x16-neumann",),
        ("tridiagonal-8x16-2-lanes",),
        ("tridiagonal-9x32-4-lanes",),
        ("tridiagonal-21x16-2-lanes-zero",),
        ("tridiagonal-9x16-4-lanes-sensor",),
    ],
    regress_verilator=[
        ("tridiagonal-8x16-2-lanes",),
        ("tridiagonal-8x16-zero",),
        ("16-flat-neumann",),
        ("16-27-neumann",),
        ("32-12",),
        ("tridiagonal-21x16-neumann",),
    ],
)
def test_rtl(run_tb: Callable[..., None], simulator: str, name: str) -> None:
    choices, level = STRUCTURES[name]
    if level == ALL and "solver" not in choices:
        level = SPECTRAL_ON_ICARUS if REGRESS and simulator == "icarus" else ALL if REGRESS else SPECTRAL
    if "lanes" in choices and simulator == "icarus" and not REGRESS:
        level = LANES_ON_ICARUS
    run(run_tb, choices, level)


@pytest.mark.parametrize("simulator", ["icarus"], indirect=True)
def test_words_side_by_side_in_the_frame_store(run_tb: Callable[..., None], simulator: str) -> None:
    """Run the frame store with several words per memory row, as on grids that are too large for this testbench."""
    choices = TRIDIAGONAL | {"columns": 32, "bits_per_channel": 2}
    run(run_tb, choices, {"LEVEL": "stream"}, {"WordsPerRow": 3, "StoreStyle": ULTRA})


@pytest.mark.seeds
@pytest.mark.structures("name", verilator=[("tridiagonal-8x16",)], regress=[("tridiagonal-8x16",)])
def test_a_second_client(run_tb: Callable[..., None], name: str) -> None:
    """Run the tests that send whole rows through cocotbext-axi; `make test` plays them up to the level formats."""
    run(run_tb, STRUCTURES[name][0], {"CLIENT": "second", **(ALL if REGRESS else FORMATS)})
