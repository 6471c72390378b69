# SPDX-License-Identifier: Apache-2.0
"""The top of the ULX3S board in simulation, at a small grid and a fast line."""

import json
from collections.abc import Callable
from typing import Any

import pytest

from commands.hardware.fpga import SOURCES, threshold
from tactile_depth.configuration import Configuration
from tactile_depth.sensor import synthetic
from tactile_depth.tactile_depth import top_parameters, write_roms
from tb.stream import REGRESS

CLOCK_MHZ = 100
CLOCKS_A_BIT = 4
QUICK = "^(?!.*broken)"  # `make regress` breaks transfers off as well


@pytest.mark.seeds
@pytest.mark.structures("", verilator=[()], regress=[()])
def test_rtl(run_tb: Callable[..., None], simulator: str) -> None:
    tests = "wakes|frames" if simulator == "icarus" else "" if REGRESS else QUICK  # 20 times slower there
    choices: dict[str, Any] = {"columns": 16, "rows": 8, "solver": "tridiagonal", "bits_per_channel": 2}
    config = Configuration(**choices)
    given: dict[str, Any] = {
        "ClockMhz": CLOCK_MHZ,
        "Baud": CLOCK_MHZ * 10**6 // CLOCKS_A_BIT,
        "Threshold": threshold(config),
    }
    run_tb(
        "ulx3s",
        None,
        {**top_parameters(config), **given},
        roms=lambda folder: write_roms(folder, synthetic(config.bits_per_channel), config),
        environment={"COCOTB_TEST_FILTER": tests, "CONFIGURATION": json.dumps(choices)},
        files=SOURCES["ulx3s"],
    )
