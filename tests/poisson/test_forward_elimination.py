# SPDX-License-Identifier: Apache-2.0
"""forward_elimination: RTL against the model; the model is tested with the whole solver."""

import json
from collections.abc import Callable
from typing import Any

import pytest

from tactile_depth.configuration import Configuration
from tactile_depth.poisson.tridiagonal_solver import solver_parameters
from tactile_depth.rom_files import write_thomas

NAMES = ["Width", "CoeffWidth", "Rows", "Columns", "StoreDrop", "Neumann", "TableWords", "SettledWidth"]
NAMES += ["LastShiftWidth", "MomentDrop", "MeanReciprocal", "MeanDrop"]
CHOICES = {"columns": 16, "rows": 8, "solver": "tridiagonal"}


@pytest.mark.structures(
    "choices",
    verilator=[(CHOICES | {"neumann": True},)],
    icarus=[
        (CHOICES,),
    ],
    regress=[
        # Few bits are dropped: ties are common.
        (CHOICES | {"neumann": True, "data_width": 12, "coefficient_width": 10},),
        (CHOICES | {"neumann": True},),
        (CHOICES | {"rows": 21, "neumann": True, "data_width": 32, "coefficient_width": 24},),
    ],
)
def test_rtl(run_tb: Callable[..., None], choices: Any) -> None:
    config = Configuration(**choices)
    parameters = solver_parameters(config)
    run_tb(
        "forward_elimination",
        {name: parameters[name] for name in NAMES} | {"OutWidth": config.data_width},
        roms=lambda folder: write_thomas(folder, config),
        environment={"CONFIGURATION": json.dumps(choices)},
    )
