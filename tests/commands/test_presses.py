# SPDX-License-Identifier: Apache-2.0
"""make presses: its tables on drawn presses, and what it measures."""

from typing import Any

import numpy as np
import pytest

import tactile_depth as td
from commands.study.presses import in_light, measured, run, sentence
from tactile_depth.calibrate.press_pictures import PressPictures, camera_pitch_mm, gather
from tactile_depth.calibrate.presses import GridPress
from tests.ball_presses import write_folder


def test_every_press_is_measured_by_the_others_and_equals_the_rtl(
    tmp_path: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    pictures = gather(write_folder(tmp_path / "presses"))
    few = PressPictures(pictures.name, pictures.presses[:10], pictures.background)
    status, document = run(few, camera_pitch_mm(few, None), "verilator")
    assert status == 0
    *places, every = document["places"]
    assert sum(place["presses"] for place in places) == every["presses"]
    assert sentence(document).endswith(f"{every['untouched_um']:.1f} um")
    lines = capsys.readouterr().out.splitlines()
    assert [line for line in lines if line.startswith("| all ")]
    total = lines[-1].split()[3]
    assert lines[-1] == f"RTL on verilator: {total} of {total} codes equal the model's"


def test_a_drawn_depth_measures_as_it_was_drawn() -> None:
    """Give a result the depth of the ball itself on flat gel."""
    grid = (96, 128)
    press = GridPress("ball", grid, 60.3, 40.8, 12.0, 22.0)
    depth = np.nan_to_num(press.depth)
    pipeline = td.Pipeline(td.load("synthetic"), grid=grid, threshold_mm=0.1, arithmetic="float")
    pitch = pipeline.pixel_pitch_mm
    codes = np.rint(depth * pitch / pipeline.depth_lsb_mm).astype(np.int32)
    none = np.zeros((*grid, 2))
    sizes = pipeline.depth_lsb_mm, pitch
    dark = np.zeros(grid, bool)
    result = td.Result(codes, depth * pitch, none, dark, None, {}, pipeline._recorder, *sizes, 1.0, None)
    found = measured(result, press)
    assert found.height_rms < 1e-12
    assert found.cap == pytest.approx(1, abs=0.04)  # the circle lies between depths
    assert (found.rest_rms, found.rest_largest) == (0, 0)
    assert found.centroid < 0.01 * pitch + pitch / 16
    assert found.area == pytest.approx(0.5, abs=0.03)  # half of a peak under 0.6 mm bounds it


def test_light_is_clipped_and_rounded() -> None:
    picture = np.array([[[10, 100, 250]]], np.uint8)
    assert in_light(picture, (1.05, 1.0, 1.1)).tolist() == [[[10, 100, 255]]]
