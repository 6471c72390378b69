# SPDX-License-Identifier: Apache-2.0
"""camera_registers: RTL against the model, the model against the settings of a camera."""

from typing import Any

import pytest

from tactile_depth.chip.camera.camera_front_end import camera_settings
from tactile_depth.chip.camera.camera_registers import CameraRegisters, camera_registers_parameters
from tactile_depth.chip.camera_configuration import CameraConfiguration
from tactile_depth.chip.registers.register_map import CAMERA_MAP, MAP
from tb.camera.tb_camera_registers import OTHER, VGA


@pytest.mark.parametrize("choices", [VGA, OTHER])
def test_after_a_reset_the_front_end_has_the_settings_of_the_camera(choices: dict[str, Any]) -> None:
    camera = CameraConfiguration(**choices)
    registers = CameraRegisters(camera_registers_parameters(camera))
    assert registers.settings == camera_settings(camera)


def test_no_offset_is_one_of_the_pipeline() -> None:
    assert not {register.offset for register in MAP} & {register.offset for register in CAMERA_MAP}
    assert {register.offset >> 6 for register in CAMERA_MAP} == {4}  # 0x100 to 0x13F
