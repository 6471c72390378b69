# SPDX-License-Identifier: Apache-2.0
"""Words of a device about the pictures of a camera in front of its camera front end."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pytest

from tactile_depth.chip.camera.camera_registers import CameraRegisters, Levels, camera_registers_parameters
from tactile_depth.chip.camera_configuration import CameraConfiguration
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.registers.axil_registers import AxilRegisters, Build, Live
from tactile_depth.chip.registers.register_map import CAMERA_MAP
from tactile_depth.chip.tactile_depth import top_parameters
from tactile_depth.device.arrived import arrived, size_doubts

CAMERA = CameraConfiguration((480, 640), (96, 128), "raw8")


class Line:
    """Registers of a device with a camera front end."""

    def __init__(self, levels: Levels, live: Live) -> None:
        self.levels, self.live = levels, live
        self.own = AxilRegisters(Build(top_parameters(Configuration(rows=96, columns=128, solver="tridiagonal"))))
        self.camera = CameraRegisters(camera_registers_parameters(CAMERA))

    def read(self, addresses: Sequence[int]) -> list[int]:
        names = {register.offset: register.name for register in CAMERA_MAP}
        return [
            self.camera.read(names[address], levels=self.levels)
            if address in names
            else self.own.read(address, self.live)[0]
            for address in addresses
        ]


WHOLE = {"arrived_columns": 640, "arrived_rows": 480}


@pytest.mark.parametrize(
    ("levels", "live", "message"),
    [
        (WHOLE, {}, ""),
        (WHOLE | {"arrived_rows": 479}, {}, "the camera sends 640 x 479, CAMERA_PICTURE is 640 x 480"),
        (WHOLE | {"arrived_columns": 1280}, {}, "the camera sends 1280 x 480, CAMERA_PICTURE is 640 x 480"),
        (WHOLE | {"arrived_rows": 0, "hunting": 1}, {}, "come without a start of picture"),
        ({"waiting": 1}, {}, "no word of the camera has come since the reset"),
        (WHOLE, {"stalled": True}, "what takes the depth stalls"),
        (WHOLE, {"arrived_columns": 128, "arrived_rows": 96}, ""),
    ],
)
def test_what_arrives_is_named(levels: dict[str, int], live: dict[str, Any], message: str) -> None:
    line: Any = Line(Levels(**levels), Live(**({"arrived_columns": 128} | live)))
    came = arrived(line, is_awaited=True)
    assert message in came.problem
    assert bool(came.problem) == bool(came.remedy) == bool(message)
    doubts = [f"{came.problem}: heights are wrong: {came.remedy}"] * ("CAMERA_PICTURE" in message)
    assert [str(doubt) for doubt in size_doubts(line)] == doubts
