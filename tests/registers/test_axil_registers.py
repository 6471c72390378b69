# SPDX-License-Identifier: Apache-2.0
"""axil_registers: RTL against the model."""

from collections.abc import Callable
from typing import Any

import pytest

from tactile_depth.configuration import Configuration
from tactile_depth.tactile_depth import config_value, default_parameters, top_parameters


def built(**choices: Any) -> dict[str, int]:
    """Return the fields of a configuration."""
    return top_parameters(Configuration(**choices), 0.0634)


EXTREMES = default_parameters() | {
    "Tridiagonal": 1,
    "Neumann": 1,
    "Rows": 65535,
    "Columns": 1,
    "DataWidth": 32,
    "GradientWidth": 32,
    "GradientFraction": 31,
    "BitsPerChannel": 1,
    "FlatField": 1,
    "Quadratic": 0,
    "ZeroOffset": 1,
    "Lanes": 32,
    "BlockLog2": 0,
    "GainWidth": 32,
    "DepthMantissa": (1 << 24) - 1,
    "DepthExponent": -128,
    "SlopeMantissa": 1 << 23,
    "SlopeExponent": 127,
    "PitchNm": (1 << 31) - 1,
}
QUADRATIC = built(columns=128, rows=96, solver="tridiagonal", flat_field=True, gradient_model="quadratic")
BUILDS = {"128": built(columns=128), "extremes": EXTREMES, "quadratic": QUADRATIC}


@pytest.mark.structures(
    "build",
    verilator=[("128",)],
    icarus=[("extremes",)],
    regress=[("128",), ("quadratic",)],
    regress_verilator=[("extremes",), ("quadratic",)],
)
def test_axil_registers(run_tb: Callable[..., None], build: Any) -> None:
    run_tb("axil_registers", parameters={"Config": config_value(BUILDS[build])})
