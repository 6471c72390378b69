# SPDX-License-Identifier: Apache-2.0
"""The tops of the ULX3S board in simulation, at a small grid and a fast line."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from commands.common import wrapper
from commands.common.repository import ROOT
from commands.common.run_request import threshold_code
from commands.hardware.fpga import SOURCES
from tactile_depth.built_in import synthetic
from tactile_depth.camera.register_lists import setup_parameters, write_list
from tactile_depth.configuration import Configuration
from tactile_depth.tactile_depth import top_parameters, write_roms
from tb.boards.tb_ulx3s_camera_bench import camera_of, sensor

CLOCK_MHZ = 100
CLOCKS_A_BIT = 4
SMALL: dict[str, Any] = {"columns": 16, "rows": 8, "solver": "tridiagonal"}
REAL_SENSOR: dict[str, Any] = {"neumann": True, "flat_field": True, "gradient_model": "quadratic", "zero_offset": True}
REAL_SENSOR |= {"data_width": 15, "coefficient_width": 18, "gain_width": 16}


def board_values(config: Configuration) -> dict[str, int]:
    """Return the parameters of a top, without those of its camera."""
    return {
        **wrapper.grid(top_parameters(config)),
        "ClockMhz": CLOCK_MHZ,
        "Baud": CLOCK_MHZ * 10**6 // CLOCKS_A_BIT,
        "Threshold": threshold_code(config),
    }


@pytest.mark.seeds
@pytest.mark.structures("", verilator=[()], regress=[()])
def test_rtl(run_tb: Callable[..., None], simulator: str, tmp_path: Path) -> None:
    level = {"LEVEL": "first"} if simulator == "icarus" else {}  # 20 times slower there
    choices: dict[str, Any] = SMALL | {"bits_per_channel": 2}
    config = Configuration(**choices)
    run_tb(
        "ulx3s",
        board_values(config),
        roms=lambda folder: write_roms(folder, synthetic(config.bits_per_channel), config),
        environment={"CONFIGURATION": json.dumps(choices), **level},
        files=[*SOURCES["ulx3s"], wrapper.write(tmp_path, "ulx3s", top_parameters(config))],
    )


@pytest.mark.seeds
@pytest.mark.structures("", icarus=[()], regress_verilator=[()])
def test_camera(run_tb: Callable[..., None], tmp_path: Path) -> None:
    """The top behind a camera, with the real-sensor build: RAW8, two by two pixels for each of the grid."""
    choices = SMALL | REAL_SENSOR
    config = Configuration(**choices)
    device = sensor(config)
    inside = wrapper.write(tmp_path, "ulx3s", top_parameters(config), camera=camera_of(config))

    def roms(folder: Path) -> None:
        write_roms(folder, synthetic(config.bits_per_channel), config)
        write_list(folder, device.entries)

    run_tb(
        "ulx3s_camera_bench",
        board_values(config) | setup_parameters(device),
        roms=roms,
        environment={"CONFIGURATION": json.dumps(choices)},
        files=[*SOURCES["ulx3s"], inside, ROOT / "tb" / "ulx3s_camera_bench.sv"],
    )
