# SPDX-License-Identifier: Apache-2.0
"""back_substitution: RTL against the model; the model is tested with the whole solver."""

import json
from collections.abc import Callable
from typing import Any

import pytest

from tactile_depth.configuration import Configuration
from tactile_depth.poisson.tridiagonal_solver import solver_parameters
from tactile_depth.rom_files import write_thomas

NAMES = ("Width", "CoeffWidth", "Rows", "Columns", "TableWords", "SettledWidth")
CHOICES = {"columns": 16, "rows": 8, "solver": "tridiagonal"}
LANES = {"columns": 32, "rows": 11, "solver": "tridiagonal", "lanes": 4}
MOST = CHOICES | {"lanes": 4}  # z of the row below does not wait


@pytest.mark.structures(
    "choices",
    verilator=[(CHOICES,), (LANES,), (MOST,)],
    icarus=[
        (CHOICES | {"neumann": True},),
        (CHOICES | {"lanes": 2},),
    ],
    regress=[
        (CHOICES | {"data_width": 12, "coefficient_width": 10},),  # few bits are dropped: ties are common
        (MOST | {"data_width": 12, "coefficient_width": 10},),
        (CHOICES,),
        (LANES,),
        (MOST,),
        (LANES | {"rows": 8, "columns": 128, "lanes": 16, "neumann": True},),  # fewer rows than lanes
        (LANES | {"rows": 11, "columns": 128, "lanes": 32, "neumann": True},),
        (CHOICES | {"rows": 21, "data_width": 32, "coefficient_width": 24},),
    ],
)
def test_rtl(run_tb: Callable[..., None], choices: Any) -> None:
    config = Configuration(**choices)
    parameters = solver_parameters(config)
    run_tb(
        "back_substitution",
        {name: parameters[name] for name in NAMES}
        | {"InWidth": config.data_width, "Drop": -parameters["StoreDrop"], "Lanes": config.lanes},
        roms=lambda folder: write_thomas(folder, config),
        environment={"CONFIGURATION": json.dumps(choices)},
    )
