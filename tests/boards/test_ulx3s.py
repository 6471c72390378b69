# SPDX-License-Identifier: Apache-2.0
"""The tops of the ULX3S board in simulation, at a small grid and a fast line."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from commands.common import wrapper
from commands.common.repository import BOARDS, ROOT
from tactile_depth.chip.camera.register_lists import setup_parameters, write_list
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.tactile_depth import top_parameters, write_roms
from tactile_depth.sensor.synthetic import synthetic
from tb.boards.tb_ulx3s_camera_bench import camera_of, sensor
from tb.structures import VERILATOR, Structure

CLOCK_MHZ = 100
CLOCKS_A_BIT = 4
SMALL: dict[str, Any] = {"columns": 16, "rows": 8, "solver": "tridiagonal"}
REAL_SENSOR: dict[str, Any] = {"neumann": True, "flat_field": True, "gradient_model": "quadratic", "zero_offset": True}
REAL_SENSOR |= {"data_width": 15, "coefficient_width": 18, "gain_width": 16}


def board_values(config: Configuration) -> dict[str, int]:
    """Return the parameters of a top, without those of its camera."""
    return {
        **wrapper.linked(top_parameters(config)),
        "ClockMhz": CLOCK_MHZ,
        "Baud": CLOCK_MHZ * 10**6 // CLOCKS_A_BIT,
    }


DEVICE = SMALL | {"bits_per_channel": 2}
BEHIND_A_CAMERA = SMALL | REAL_SENSOR


def built() -> Structure:
    config = Configuration(**DEVICE)
    return Structure(
        board_values(config),
        on=VERILATOR,
        device={"configuration": DEVICE},
        roms=lambda folder: write_roms(folder, synthetic(config.bits_per_channel), config),
        name="ulx3s",
    )


def built_camera() -> Structure:
    config = Configuration(**BEHIND_A_CAMERA)
    device = sensor(config)

    def roms(folder: Path) -> None:
        write_roms(folder, synthetic(config.bits_per_channel), config)
        write_list(folder, device.entries)

    return Structure(
        board_values(config) | setup_parameters(device),
        on=VERILATOR,
        device={"configuration": BEHIND_A_CAMERA},
        roms=roms,
        name="camera",
    )


@pytest.mark.seeds
@pytest.mark.structures([built()])
def test_rtl(run_tb: Callable[..., None], simulator: str, structure: Structure, tmp_path: Path) -> None:
    inside = wrapper.write(tmp_path, "ulx3s", top_parameters(Configuration(**DEVICE)))
    level = "first" if simulator == "icarus" else ""  # 20 times slower there
    run_tb(structure, files=[*BOARDS["ulx3s"], inside], level=level)


@pytest.mark.seeds
@pytest.mark.structures([built_camera()])
def test_camera(run_tb: Callable[..., None], structure: Structure, tmp_path: Path) -> None:
    """The top behind a camera, with the real-sensor build: RAW8, two by two pixels for each of the grid."""
    config = Configuration(**BEHIND_A_CAMERA)
    inside = wrapper.write(tmp_path, "ulx3s", top_parameters(config, camera=camera_of(config)))
    bench = ROOT / "tb" / "ulx3s_camera_bench.sv"
    run_tb(structure, toplevel="ulx3s_camera_bench", files=[*BOARDS["ulx3s"], inside, bench])
