# SPDX-License-Identifier: Apache-2.0
"""camera_front_end: RTL against the model, the model against the resampling of the Python package."""

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tactile_depth.camera.camera_front_end import camera_front_end, camera_front_end_parameters
from tactile_depth.camera.pixel_format import photograph
from tactile_depth.camera_configuration import FORMATS, PHASES, CameraConfiguration
from tactile_depth.resampling import resampling

GRID = (4, 8)


def arguments(form: str, picture: tuple[int, int], **choices: Any) -> dict[str, Any]:
    return {"picture": picture, "grid": GRID, "pixel_format": form, **choices}


@pytest.mark.structures(
    "choices",
    verilator=[(arguments("raw10", (17, 34), phase="gbrg"),)],
    icarus=[
        (arguments("raw8", (9, 17), phase="grbg", byte_serial=True),),
        (arguments("yuyv", (10, 16), byte_serial=True),),
        (arguments("rgb888", (4, 9)),),
    ],
    regress=[
        *((arguments(form, (12, 22), phase=phase),) for form in ("raw8", "raw10", "raw12") for phase in PHASES),
        (arguments("yuyv", (7, 18), window=[3, 1, 10, 5]),),
        (arguments("yuyv", (7, 18), window=[4, 1, 9, 5]),),
        (arguments("rgb565", (21, 40)),),
        (arguments("rgb565", (21, 40), byte_serial=True),),
        (arguments("rgb888", (32, 64)),),
        (arguments("raw12", (32, 64), msb_aligned=False),),
    ],
    regress_verilator=[(arguments("yuyv", (10, 16)),), (arguments("rgb888", (4, 9)),)],
)
def test_rtl(run_tb: Callable[..., None], choices: dict[str, Any]) -> None:
    camera = CameraConfiguration(**choices)
    run_tb("camera_front_end", camera_front_end_parameters(camera), environment={"CAMERA": json.dumps(choices)})


@pytest.mark.parametrize("picture", [(4, 8), (480, 640), (240, 320), (33, 70), (100, 90)])
def test_rgb_equals_the_resampling_of_the_package(picture: tuple[int, int]) -> None:
    camera = CameraConfiguration(picture, GRID)
    colours = np.random.default_rng(1).integers(0, 256, (*picture, 3), dtype=np.uint8)
    frame = camera_front_end(photograph(colours, camera), camera)
    np.testing.assert_array_equal(frame, np.rint(resampling(picture, GRID).average(colours)))


def test_a_window_is_a_picture_of_its_own() -> None:
    colours = np.random.default_rng(1).integers(0, 256, (60, 80, 3), dtype=np.uint8)
    camera = CameraConfiguration((60, 80), GRID, window=(11, 7, 36, 18))
    frame = camera_front_end(photograph(colours, camera), camera)
    np.testing.assert_array_equal(frame, np.rint(resampling((18, 36), GRID).average(colours[7:25, 11:47])))


@pytest.mark.parametrize("form", FORMATS)
def test_a_uniform_picture_keeps_its_colour(form: str) -> None:
    colours = np.tile(np.array([200, 100, 50], np.uint8), (60, 80, 1))
    camera = CameraConfiguration((60, 80), GRID, form, window=(3, 1, 45, 23))
    frame = camera_front_end(photograph(colours, camera), camera)
    assert (frame == frame[0, 0]).all()
    steps = {"rgb565": [4, 2, 4], "yuyv": [1, 1, 1]}.get(form, [0, 0, 0])
    assert (np.abs(frame[0, 0].astype(int) - [200, 100, 50]) <= steps).all()


def test_black_level_and_gains_scale_the_colours() -> None:
    colours = np.tile(np.array([110, 60, 30], np.uint8), (60, 80, 1))
    for form in ("raw10", "rgb888"):
        scale = 4 if form == "raw10" else 1
        camera = CameraConfiguration((60, 80), GRID, form, black_level=10 * scale, gains=(1.0, 2.0, 4.0))
        frame = camera_front_end(photograph(colours, camera), camera)
        assert frame[0, 0].tolist() == [100, 100, 80]
