# SPDX-License-Identifier: Apache-2.0
"""camera_registers: RTL against the model, the model against the settings of a camera."""

from typing import Any

import pytest

from formal.entries import FULL_WIDTH, Proof
from tactile_depth.chip.camera.camera_front_end import camera_settings
from tactile_depth.chip.camera.camera_registers import CameraRegisters, camera_registers_parameters
from tactile_depth.chip.camera_configuration import CameraConfiguration
from tactile_depth.chip.registers.register_map import CAMERA_MAP, MAP
from tb.structures import ICARUS, VERILATOR, Mutants, Structure
from tests.rtl import test_rtl as test_rtl

VGA: dict[str, Any] = {"picture": (480, 640), "grid": (128, 128), "pixel_format": "raw10", "phase": "grbg"}
OTHER: dict[str, Any] = {
    "picture": (240, 320),
    "grid": (96, 128),
    "pixel_format": "yuyv_bytes",
    "window": (7, 5, 256, 192),
    "black_level": 341,
    "gains": (1.5, 0.25, 15.75),
}


def built(choices: dict[str, Any], **runs: Any) -> Structure:
    return Structure(camera_registers_parameters(CameraConfiguration(**choices)), **runs)


STRUCTURES = (
    built(VGA, on=VERILATOR),
    built(OTHER, on=ICARUS, late=VERILATOR, mutants=True),
)
MUTANTS = Mutants(
    "after_reset",
    outside=(
        "dropped",
        "lost",
    ),
    flat=False,
)
REFUSED = {
    "PictureColumns=8192": "pictures_and_windows_have_up_to_8191_rows_and_columns",
    "WindowY=-1": "pictures_and_windows_have_up_to_8191_rows_and_columns",
    "WindowRows=8192": "pictures_and_windows_have_up_to_8191_rows_and_columns",
    "BlackLevel=4096": "BlackLevel_must_fit_12_bits_and_gains_16",
    "BlueGain=65536": "BlackLevel_must_fit_12_bits_and_gains_16",
}
PROOFS = (
    Proof(
        "every register as the map has it: words, settings that leave, sticky bits, counters",
        FULL_WIDTH,
    ),
)


@pytest.mark.parametrize("choices", [VGA, OTHER])
def test_after_a_reset_the_front_end_has_the_settings_of_the_camera(choices: dict[str, Any]) -> None:
    camera = CameraConfiguration(**choices)
    registers = CameraRegisters(camera_registers_parameters(camera))
    assert registers.settings == camera_settings(camera)


def test_no_offset_is_one_of_the_pipeline() -> None:
    assert not {register.offset for register in MAP} & {register.offset for register in CAMERA_MAP}
    assert {register.offset >> 6 for register in CAMERA_MAP} == {4}  # 0x100 to 0x13F
