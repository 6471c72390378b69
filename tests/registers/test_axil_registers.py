# SPDX-License-Identifier: Apache-2.0
"""hdl/registers/axil_registers.sv against models/tactile_depth/registers/axil_registers.py."""

from collections.abc import Callable
from typing import Any

import pytest

from tactile_depth.configuration import Configuration

SOURCES = ["register_map_pkg.sv", "axil_registers.sv"]


def built(configuration: Configuration) -> dict[str, int]:
    return {
        "Rows": configuration.rows,
        "Columns": configuration.columns,
        "DataWidth": configuration.data_width,
        "GradientWidth": configuration.gradient.width,
        "GradientFraction": configuration.gradient.fraction,
        "BitsPerChannel": configuration.bits_per_channel,
    }


EXTREMES = {
    "Rows": 65535,
    "Columns": 1,
    "DataWidth": 32,
    "GradientWidth": 32,
    "GradientFraction": 31,
    "BitsPerChannel": 1,
    "CoefficientWords": 36,
    "ReferenceWords": 5000,
    "FloorWords": 1250,
}

QUADRATIC = EXTREMES | {"BitsPerChannel": 0, "ReferenceWords": 0, "FloorWords": 300}
BUILDS = {"128": built(Configuration(columns=128)), "extremes": EXTREMES, "without-gradient-table": QUADRATIC}


@pytest.mark.structures(
    "build",
    verilator=[("128",)],
    icarus=[("without-gradient-table",)],
    regress=[("128",), ("extremes",)],
    regress_verilator=[("extremes",), ("without-gradient-table",)],
)
def test_axil_registers(run_tb: Callable[..., None], build: Any) -> None:
    run_tb("axil_registers", SOURCES, parameters=BUILDS[build])
