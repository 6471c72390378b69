# SPDX-License-Identifier: Apache-2.0
"""Fields of Config that hdl/camera/camera_unit.sv reads."""

from __future__ import annotations

from tactile_depth.camera.camera_front_end import camera_front_end_parameters, camera_settings
from tactile_depth.camera_configuration import CameraConfiguration

OF_GRID = ("Rows", "Columns")
"""Parameters that are fields of the pipeline."""
DEFAULT = CameraConfiguration(picture=(480, 640), grid=(128, 128), pixel_format="raw10")


def camera_fields(camera: CameraConfiguration | None) -> dict[str, int]:
    """Return the fields of a camera; None: a pipeline without a camera."""
    if camera is None:
        return {"Camera": 0}
    settings = camera_settings(camera)
    front_end = camera_front_end_parameters(camera)
    return {
        "Camera": 1,
        **{f"Camera{name}": number for name, number in front_end.items() if name not in OF_GRID},
        "CameraPictureColumns": settings["columns"],
        "CameraPictureRows": settings["rows"],
        "CameraWindowX": settings["window_x"],
        "CameraWindowY": settings["window_y"],
        "CameraBlackLevel": settings["black_level"],
        "CameraRedGain": settings["red_gain"],
        "CameraGreenGain": settings["green_gain"],
        "CameraBlueGain": settings["blue_gain"],
    }
