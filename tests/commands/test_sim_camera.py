# SPDX-License-Identifier: Apache-2.0
"""`make sim CAMERA=..`: every format through the RTL of the front end, latency, depth error, bad input."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from commands.common import run_request
from commands.run import sim
from commands.study.accuracy import errors
from tactile_depth.base.errors import InputError
from tactile_depth.chip.camera_configuration import FORMATS, CameraChoice, CameraConfiguration
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.contact.threshold_comparator import LATENCY
from tactile_depth.chip.latency import last_word_to_first_depth
from tactile_depth.depth.twin import Twin
from tactile_depth.pictures.frames import SCENE_PICTURE, load_frames, on_grid
from tactile_depth.sensor.built_in import load
from tactile_depth.sensor.scenes import render

PICTURE = (36, 48)  # rows and columns
ARGUMENTS = ("SOLVER=tridiagonal", "N=16", "SIM=icarus", "CALIBRATION=synthetic")
# Mean over the contacts of the bench, in % of peak: 0.23, 0.107, 0.244 as measured. RAW8 and RAW12 carry the same
# picture of 8 bits as RAW10.
BARS = {"rgb888": 0.0, "rgb565": 0.24, "yuyv": 0.12, "raw8": 0.25, "raw10": 0.25, "raw12": 0.25}


def parsed(*arguments: str) -> run_request.Request:
    return run_request.parse(list(arguments), (*run_request.ACCEPTED, *run_request.CAMERA))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with two pictures of a contact, larger than the grid and of another aspect ratio."""
    pictures = tmp_path / "pictures"
    pictures.mkdir()
    for name in ("ball", "cone"):
        Image.fromarray(render(name, *PICTURE).frames[0]).save(pictures / f"{name}.png")
    return pictures


def run(folder: Path, *arguments: str) -> dict[str, Any]:
    out = folder.parent / "out"
    assert sim.run(parsed(f"FRAMES={folder}", *ARGUMENTS, *arguments, f"OUT={out}")) == 0
    report: dict[str, Any] = json.loads((out / "report.json").read_text())
    assert report["bit_exact"]
    assert report["registers_agree"]
    return report


@pytest.mark.parametrize(
    ("form", "arguments"),
    [
        ("raw10", ("BAYER=grbg", "GAPS=0.3")),
        ("yuyv_bytes", ("WINDOW=7,1,33,33",)),  # the window ends between the two pixels of a pair
        *(pytest.param(form, ("GAPS=0.3",), marks=pytest.mark.regress) for form in FORMATS),
        pytest.param("raw12", ("BAYER=bggr", "WINDOW=3,2,33,33", "REPEAT=2"), marks=pytest.mark.regress),
    ],
)
def test_the_cycles_from_the_last_word_are_those_of_the_model(
    folder: Path, form: str, arguments: tuple[str, ...]
) -> None:
    """Compare the cycles to the first depth and to contact for every picture, with gaps and blanking."""
    report = run(folder, f"CAMERA={form}", *arguments)
    choice = parsed(f"CAMERA={form}", *arguments).camera
    assert choice is not None
    expected = last_word_to_first_depth(choice.on(PICTURE, (16, 16)), Configuration(columns=16, solver="tridiagonal"))
    assert set(report["last_pixel_to_first_depth_cycles"]) == {expected}
    assert report["expected_last_pixel_to_first_depth_cycles"] == expected
    codes = np.load(folder.parent / "out" / "depth.npy")[:, ::-1].reshape(report["frames"], -1)  # as they leave
    threshold = round(report["contact_threshold_mm"] / report["depth_lsb_mm"])
    to_contact = [expected + int(place) + LATENCY for place in (codes > threshold).argmax(axis=1)]
    assert report["last_pixel_to_contact_cycles"] == to_contact


def test_stalls_lose_nothing(folder: Path) -> None:
    quiet = run(folder, "CAMERA=raw8")
    codes = np.load(folder.parent / "out" / "depth.npy")
    run(folder, "CAMERA=raw8", "STALLS=0.4")
    np.testing.assert_array_equal(np.load(folder.parent / "out" / "depth.npy"), codes)
    assert quiet["camera"] == {
        "pixel_format": "raw8",
        "bayer": "rggb",
        "picture": list(PICTURE),
        "window": [6, 0, 36, 36],
        "pixels_per_grid_pixel": 2.25,
    }


def test_rgb888_is_what_the_package_averages(folder: Path) -> None:
    report = run(folder, "CAMERA=rgb888")
    with_camera = np.load(folder.parent / "out" / "depth.npy")
    assert report["camera_rms_percent_of_peak"] == pytest.approx(report["rms_percent_of_peak"])
    out = folder.parent / "plain"
    assert sim.run(parsed(f"FRAMES={folder}", *ARGUMENTS, f"OUT={out}")) == 0
    np.testing.assert_array_equal(np.load(out / "depth.npy"), with_camera)


def test_each_format_costs_little_depth() -> None:
    """Compute depth at 128 from a scene of 640 x 480: the RTL equals the model, and the loss against RGB is small."""
    grid = (128, 128)
    config = Configuration(columns=grid[1], solver="tridiagonal")
    depth = {}
    for form in ("rgb888", "rgb565", "yuyv", "raw10"):
        frames = load_frames("bench", grid, camera=CameraChoice(form))
        depth[form] = Twin(on_grid(load("synthetic"), frames), config).exact_px(frames.pixels)
    for form, ours in depth.items():
        lost = [value for value in errors(ours, depth["rgb888"])["rms_percent_of_peak"] if value is not None]
        assert np.mean(lost) <= BARS[form], form
        assert max(lost) <= 3 * BARS[form], form


def refused(*arguments: str) -> str:
    with pytest.raises(InputError) as caught:
        sim.run(parsed(*ARGUMENTS, *arguments))
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("CAMERA=raw11",), "=raw11 is unknown: accepted are rgb888, rgb565"),
        (("CAMERA=raw10", "BAYER=rgbg"), "=rgbg is unknown: accepted are rggb, grbg, gbrg, bggr"),
        (("CAMERA=yuyv", "BAYER=grbg"), "it goes with raw8, raw10, raw10_lsb, raw12"),
        (("BAYER=grbg",), "BAYER=grbg goes with CAMERA"),
        (("WINDOW=0,0,16,16",), "WINDOW=0,0,16,16 goes with CAMERA"),
        (("CAMERA=raw10", "WINDOW=0,0,16"), "accepted is x,y,width,height in pixels"),
        (("CAMERA=raw10", "WINDOW=200,0,480,480"), "is not inside the picture of 640 x 480"),
        (("CAMERA=raw10", "WINDOW=0,0,480,400"), "has not the aspect ratio of the grid of 16 x 16"),
        (("CAMERA=raw10", "WINDOW=0,0,24,24"), "below it some blocks lack a colour"),
        (("CAMERA=raw10", "N=256"), "is 1.88 pixels for each of the grid: 2 are needed"),
        (("CAMERA=rgb888", "N=512"), "are smaller than the grid"),
    ],
)
def test_bad_input_is_one_line(arguments: tuple[str, ...], says: str) -> None:
    assert says in refused(*arguments)


def test_the_picture_of_a_scene_is_as_a_vga_camera_takes_it() -> None:
    frames = load_frames("ball", (32, 32), camera=CameraChoice("raw10"))
    assert frames.camera == CameraConfiguration(SCENE_PICTURE, (32, 32), "raw10")
    assert frames.words is not None
    assert frames.words.shape == (1, *SCENE_PICTURE)
