# SPDX-License-Identifier: Apache-2.0
"""Fields of Config that hdl/camera/camera_unit.sv reads."""

from __future__ import annotations

from tactile_depth.chip.camera.camera_front_end import camera_front_end_parameters, reset_parameters
from tactile_depth.chip.camera_configuration import CameraConfiguration

OF_GRID = ("Rows", "Columns")
"""Parameters that are fields of the pipeline."""
DEFAULT = CameraConfiguration(picture=(480, 640), grid=(128, 128), pixel_format="raw10")


def camera_fields(camera: CameraConfiguration | None) -> dict[str, int]:
    """Return the fields of a camera; None: a pipeline without a camera."""
    if camera is None:
        return {"Camera": 0}
    parameters = camera_front_end_parameters(camera) | reset_parameters(camera)
    return {
        "Camera": 1,
        **{f"Camera{name}": number for name, number in parameters.items() if name not in OF_GRID},
    }
