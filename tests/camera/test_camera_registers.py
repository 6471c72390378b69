# SPDX-License-Identifier: Apache-2.0
"""camera_registers: RTL against the model, the model against the settings of a camera."""

from collections.abc import Callable
from typing import Any

import pytest

from tactile_depth.camera.camera_front_end import camera_settings
from tactile_depth.camera.camera_registers import CameraRegisters, camera_registers_parameters
from tactile_depth.camera_configuration import CameraConfiguration
from tactile_depth.registers.register_map import CAMERA_MAP, MAP

VGA: dict[str, Any] = {"picture": (480, 640), "grid": (128, 128), "pixel_format": "raw10", "phase": "grbg"}
OTHER: dict[str, Any] = {
    "picture": (240, 320),
    "grid": (96, 128),
    "pixel_format": "yuyv_bytes",
    "window": (7, 5, 256, 192),
    "black_level": 341,
    "gains": (1.5, 0.25, 15.75),
}


@pytest.mark.structures(
    "choices", verilator=[(VGA,)], icarus=[(OTHER,)], regress=[(VGA,)], regress_verilator=[(OTHER,)]
)
def test_rtl(run_tb: Callable[..., None], choices: dict[str, Any]) -> None:
    run_tb("camera_registers", camera_registers_parameters(CameraConfiguration(**choices)))


@pytest.mark.parametrize("choices", [VGA, OTHER])
def test_after_a_reset_the_front_end_has_the_settings_of_the_camera(choices: dict[str, Any]) -> None:
    camera = CameraConfiguration(**choices)
    registers = CameraRegisters(camera_registers_parameters(camera))
    assert registers.settings == camera_settings(camera)


def test_no_offset_is_one_of_the_pipeline() -> None:
    assert not {register.offset for register in MAP} & {register.offset for register in CAMERA_MAP}
    assert {register.offset >> 6 for register in CAMERA_MAP} == {4}  # 0x100 to 0x13F
