# SPDX-License-Identifier: Apache-2.0
"""The top of the ULX3S board in simulation, at a small grid and a fast line."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from commands.common import wrapper
from commands.common.run_request import threshold_code
from commands.hardware.fpga import SOURCES
from tactile_depth.configuration import Configuration
from tactile_depth.sensor import synthetic
from tactile_depth.tactile_depth import top_parameters, write_roms

CLOCK_MHZ = 100
CLOCKS_A_BIT = 4


@pytest.mark.seeds
@pytest.mark.structures("", verilator=[()], regress=[()])
def test_rtl(run_tb: Callable[..., None], simulator: str, tmp_path: Path) -> None:
    level = {"LEVEL": "first"} if simulator == "icarus" else {}  # 20 times slower there
    choices: dict[str, Any] = {"columns": 16, "rows": 8, "solver": "tridiagonal", "bits_per_channel": 2}
    config = Configuration(**choices)
    values: dict[str, Any] = {
        "ClockMhz": CLOCK_MHZ,
        "Baud": CLOCK_MHZ * 10**6 // CLOCKS_A_BIT,
        "Threshold": threshold_code(config),
    }
    run_tb(
        "ulx3s",
        {**wrapper.grid(top_parameters(config)), **values},
        roms=lambda folder: write_roms(folder, synthetic(config.bits_per_channel), config),
        environment={"CONFIGURATION": json.dumps(choices), **level},
        files=[*SOURCES["ulx3s"], wrapper.write(tmp_path, "ulx3s", top_parameters(config))],
    )
