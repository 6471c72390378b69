# SPDX-License-Identifier: Apache-2.0
"""camera_front_end: RTL against the model, the model against the resampling of the Python package."""

import math
import subprocess
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from commands.common import repository, simulator
from tactile_depth.base.errors import InputError
from tactile_depth.chip.camera.camera_front_end import camera_front_end, camera_front_end_parameters
from tactile_depth.chip.camera.pixel_format import photograph
from tactile_depth.chip.camera_configuration import FORMATS, CameraChoice, CameraConfiguration
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.latency import last_pixel_to_first_depth, last_word_to_first_depth
from tactile_depth.chip.resampling import resampling
from tb.camera.tb_camera_front_end import GRID, PATTERNS, RATIOS, every_format_phase_and_ratio


@pytest.mark.parametrize(
    ("form", "ratio"),
    [(form, ratio) for form in ("rgb888", "yuyv", "raw10") for ratio in RATIOS if ratio >= FORMATS[form].least_ratio],
)
def test_verilator_has_no_warning_at_any_ratio(form: str, ratio: Fraction) -> None:
    """A warning ends a run of make sim."""
    simulator.check("verilator")
    camera = CameraConfiguration((math.ceil(GRID[0] * ratio), int(GRID[1] * ratio)), GRID, form)
    parameters = [f"-G{name}={value}" for name, value in camera_front_end_parameters(camera).items()]
    top = ["--top-module", "camera_front_end"]
    sources = [*repository.WAIVERS, *repository.sources("camera_front_end")]
    command = [simulator.VERILATOR, "--lint-only", "-Wall", "--quiet", *top, *parameters, *map(str, sources)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout + result.stderr


def test_every_format_phase_and_ratio_is_among_the_structures() -> None:
    cameras = [CameraConfiguration(**choices) for choices in every_format_phase_and_ratio()]
    assert {(camera.pixel_format, camera.phase) for camera in cameras if camera.format.bayer} == set(PATTERNS)
    assert {camera.pixel_format for camera in cameras} == set(FORMATS)
    assert {camera.ratio for camera in cameras if not camera.format.bayer} == set(RATIOS)
    assert {camera.ratio for camera in cameras if camera.format.bayer} == {ratio for ratio in RATIOS if ratio >= 2}


@pytest.mark.parametrize("window", [None, (11, 7, 36, 18)])
@pytest.mark.parametrize("picture", [(480, 640), (240, 320), (33, 70), (100, 90)])
def test_rgb_equals_the_resampling_of_the_package(picture: tuple[int, int], window: Any) -> None:
    colours = np.random.default_rng(1).integers(0, 256, (*picture, 3), dtype=np.uint8)
    camera = CameraConfiguration(picture, GRID, window=window)
    shown = colours[7:25, 11:47] if window else colours
    frame = camera_front_end(photograph(colours, camera), camera)
    np.testing.assert_array_equal(frame, np.rint(resampling(shown.shape[:2], GRID).average(shown)))


@pytest.mark.parametrize("form", FORMATS)
def test_a_uniform_picture_keeps_its_colour(form: str) -> None:
    colours = np.tile(np.array([200, 100, 50], np.uint8), (60, 80, 1))
    camera = CameraConfiguration((60, 80), GRID, form, window=(3, 1, 45, 23))
    frame = camera_front_end(photograph(colours, camera), camera)
    assert (frame == frame[0, 0]).all()
    steps = {"rgb565": [4, 2, 4], "yuyv": [1, 1, 1]}.get(form.removesuffix("_bytes"), [0, 0, 0])
    assert (np.abs(frame[0, 0].astype(int) - [200, 100, 50]) <= steps).all()


def test_the_page_has_the_latency() -> None:
    config = Configuration(columns=128, solver="tridiagonal")
    pipeline = last_pixel_to_first_depth(config)
    cycles = {form: last_word_to_first_depth(CameraChoice(form).on((480, 640), (128, 128)), config) for form in FORMATS}
    pairs = {form for form, count in cycles.items() if count != cycles["rgb888"]}
    assert pairs == {"yuyv", "yuyv_bytes"}
    rgb, yuyv = cycles["rgb888"], cycles["yuyv"]
    page = " ".join((repository.ROOT / "docs" / "camera.md").read_text().split())
    assert f"the front end takes {rgb - pipeline} cycles, for YUYV whose" in page
    assert f"second pixel of a pair {yuyv - pipeline}; with a tridiagonal pipeline" in page
    assert f"colours as sent, {rgb} and {yuyv}." in page


def test_a_pattern_below_a_ratio_of_two_is_refused() -> None:
    assert CameraChoice("raw8").on((256, 256), (128, 128)).ratio == 2
    with pytest.raises(InputError, match="2 are needed: below it some blocks lack a colour"):
        CameraChoice("raw8").on((254, 254), (128, 128))
