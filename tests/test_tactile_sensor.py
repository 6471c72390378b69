# SPDX-License-Identifier: Apache-2.0
"""tactile_sensor: RTL against the models, with settings that are written over its bus."""

from collections.abc import Callable
from typing import Any

from tactile_depth.chip.camera_configuration import CameraConfiguration
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.tactile_depth import hdl_parameters, write_roms
from tactile_depth.sensor.synthetic import synthetic
from tb.structures import ICARUS, VERILATOR, Mutants, Structure

PIPELINE: dict[str, Any] = {"columns": 16, "rows": 8, "solver": "tridiagonal", "bits_per_channel": 2}


def built(form: str, picture: tuple[int, int], window: tuple[int, int, int, int], **runs: Any) -> Structure:
    config = Configuration(**PIPELINE)
    camera = {"picture": picture, "grid": (8, 16), "pixel_format": form, "window": window}
    return Structure(
        hdl_parameters(config, camera=CameraConfiguration(**camera)),  # type: ignore[arg-type]
        device={"configuration": PIPELINE, "camera": camera},
        roms=lambda folder: write_roms(folder, synthetic(config.bits_per_channel), config),
        name=form,
        **runs,
    )


STRUCTURES = (
    built("raw10_lsb", (23, 42), (3, 2, 36, 18), on=VERILATOR, mutants=True),
    built("yuyv_bytes", (13, 28), (2, 1, 24, 12), on=ICARUS, late=VERILATOR),
)
MUTANTS = Mutants("tactile_depth", simulators=VERILATOR, flat=False)
REFUSED = {"Camera=0": "Config_has_no_camera"}
NO_PROOF = "camera_unit and tactile_depth in a row"


def test_rtl(run_tb: Callable[..., None], structure: Structure) -> None:
    run_tb(structure)
