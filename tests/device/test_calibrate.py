# SPDX-License-Identifier: Apache-2.0
"""`tactile-depth calibrate`, with and without a device: the file it writes, what it prints, and bad input."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import tactile_depth as td
from tactile_depth.base.files import RECORD
from tactile_depth.calibrate.fitting import fit_presses
from tactile_depth.calibrate.press_pictures import gather
from tactile_depth.calibrate.presses import GridPresses, to_grid
from tactile_depth.cli.main import main
from tactile_depth.cli.measure import grid_of
from tests import ball_presses
from tests.device.cable import setup_of
from tests.device.conftest import Plug
from tests.device.model_device import Setup

DRAWN = 12
GRID = (45, 64)
OPTIONS = ["--grid", "64x45", "--model", "quadratic", "--pitch-mm", str(ball_presses.PITCH)]
TOLERANCE = 0.1  # of the height RMS, to that of a fit to files


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return ball_presses.write_folder(tmp_path_factory.mktemp("drawn") / "presses", DRAWN)


@pytest.fixture(scope="module")
def presses(folder: Path) -> GridPresses:
    return to_grid(gather(folder), ball_presses.PITCH, grid=GRID)


@pytest.fixture(scope="module")
def sensor(presses: GridPresses) -> td.Sensor:
    """Calibration that the command fits."""
    return fit_presses(presses, ("quadratic",)).sensor


@pytest.fixture(scope="module")
def fitted(folder: Path, sensor: td.Sensor) -> td.Pipeline:
    return td.Pipeline(sensor, folder / "background.png", grid=GRID)


def from_files(folder: Path, presses: GridPresses) -> td.Sensor:
    """Return the fit to the pictures on the grid, written to files."""
    folder.mkdir()
    Image.fromarray(presses.background_on_grid).save(folder / "background.png")
    with (folder / "presses.csv").open("w", newline="") as file:
        table = csv.writer(file)
        table.writerow(ball_presses.COLUMNS[:5])
        for view in presses.views:
            press = view.press
            Image.fromarray(view.frame).save(folder / press.name)
            table.writerow([press.name, view.diameter_mm, press.x, press.y, press.contact_radius])
    return td.fit(folder, pitch_mm=presses.grid_pitch_mm, models="quadratic", quiet=True)


def height_rms_um(sensor: td.Sensor, presses: GridPresses) -> float:
    """Return the mean height RMS of the whole presses in um, by the package, of pictures on the grid."""
    pipeline = td.Pipeline(sensor, presses.background_on_grid, grid=GRID)
    views = [view for view in presses.views if view.is_whole]
    pitch_mm = pipeline.pixel_pitch_mm
    depths_mm = [list(pipeline.stream([view.frame] * 4))[-1].depth_mm for view in views]
    rms = [view.press.height_rms(depth / pitch_mm) for view, depth in zip(views, depths_mm, strict=True)]
    return 1000 * pitch_mm * float(np.mean(rms))


def test_the_device_reads_the_presses_as_the_package_does_and_as_a_fit_to_files_does(
    tmp_path: Path,
    folder: Path,
    presses: GridPresses,
    fitted: td.Pipeline,
    simulate: Callable[[Setup], None],
    capsys: pytest.CaptureFixture[str],
) -> None:
    simulate(setup_of(fitted))
    out = tmp_path / "mine.npz"
    assert main(["calibrate", "device:sim", str(folder), *OPTIONS, "--out", str(out)]) == 0
    printed = capsys.readouterr().out
    rows = re.findall(r"^(\d\d\.png) +(yes|no) +([\d.]+) +([\d.]+)$", printed, re.MULTILINE)
    assert [name for name, *_ in rows] == [view.press.name for view in presses.views]
    assert all(touching == "yes" and device == package for _, touching, device, package in rows)
    last = re.search(
        r"height RMS of \d+ whole presses: device ([\d.]+) um, package ([\d.]+) um$", printed, re.MULTILINE
    )
    assert last is not None
    assert last[1] == last[2]
    by_files = height_rms_um(from_files(tmp_path / "files", presses), presses)
    assert abs(float(last[1]) / by_files - 1) <= TOLERANCE
    np.testing.assert_array_equal(td.load(out).coefficients, fitted.sensor.coefficients)


def test_the_file_is_that_of_a_fit_in_python(
    tmp_path: Path, folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["calibrate", str(folder), "--model", "quadratic"]) == 0
    captured = capsys.readouterr()
    assert captured.err == ""
    assert captured.out.endswith("results: presses.npz\n")
    expected = td.fit(folder, models="quadratic", quiet=True)
    expected.save(tmp_path / "expected.npz")
    with np.load("presses.npz") as written, np.load("expected.npz") as other:
        assert sorted(written) == sorted(other)
        for key in written:
            np.testing.assert_array_equal(written[key], other[key])
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        RECORD,
        "expected.npz",
        *(f"presses{end}" for end in ("-circles.csv", "-circles.html", "-circles.png", ".npz")),
    ]


def test_a_device_on_a_line_gives_the_grid_before_the_fit(
    folder: Path, fitted: td.Pipeline, plug: Plug, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cable = plug(fitted)
    words = ["calibrate", f"device:{cable.address}", str(folder), "--out", str(tmp_path / "mine.npz")]
    assert main([*words, "--grid", "64x44"]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    (line,) = captured.err.splitlines()
    assert "--grid 64x44: the device has another grid: omit it, or give --grid 64x45" in line
    assert grid_of(cable.address) == GRID


def test_pictures_of_one_ball_need_no_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("skimage")
    of_one = {name: picture for name, picture in ball_presses.pictures().items() if name[0] == "b" or int(name[:2]) % 2}
    for name, picture in of_one.items():
        Image.fromarray(picture).save(tmp_path / name)
    out = tmp_path / "mine.npz"
    given = ["--diameter-mm", "8", "--pitch-mm", str(ball_presses.PITCH), "--model", "quadratic"]
    assert main(["calibrate", str(tmp_path), *given, "--out", str(out)]) == 0
    assert "12 presses, grid of 128 x 90" in capsys.readouterr().out
    assert td.load(out).models == ("quadratic",)


def test_a_press_without_contact_is_told(
    folder: Path,
    fitted: td.Pipeline,
    simulate: Callable[[Setup], None],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Give the device a threshold that no press reaches."""
    load = td.Device.load

    def load_and_raise(device: td.Device) -> None:
        load(device)
        device.set_thresholds(touch_mm=2)

    simulate(setup_of(fitted))
    monkeypatch.setattr(td.Device, "load", load_and_raise)
    assert main(["calibrate", "device:sim", str(folder), *OPTIONS, "--out", str(tmp_path / "mine.npz")]) == 0
    captured = capsys.readouterr()
    assert "  no  " in captured.out
    assert "tactile-depth: warning: the device sees no contact in 00.png, 01.png" in captured.err


def test_a_device_of_another_configuration_leaves_no_file(
    tmp_path: Path,
    folder: Path,
    sensor: td.Sensor,
    simulate: Callable[[Setup], None],
    capsys: pytest.CaptureFixture[str],
) -> None:
    other = td.Pipeline(sensor, folder / "background.png", grid=GRID, data_width=20)
    simulate(setup_of(other))
    out = tmp_path / "out" / "mine.npz"
    words = ["calibrate", "device:sim", str(folder), *OPTIONS, "--out", str(out)]
    assert main(words) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "the device has another configuration: FORMAT.data_width is 20, that of the pipeline 24" in line
    assert not out.parent.exists()
    assert main([*words, "--data-width", "20"]) == 0
    assert out.exists()


@pytest.mark.parametrize(
    ("words", "status", "message"),
    [
        (["device:sim"], 2, "device:sim: a device sends no camera pictures to its host"),
        (["sim", "{}"], 2, "sim: no device: give device:/dev/ttyUSB0"),
        (["device:bus", "{}"], 2, "device:bus is no address of a device"),
        (["device:/dev/none", "{}"], 2, "there is no such port"),
        (["{}", "--diameter-mm", "6"], 2, "presses.csv has the diameters: omit one of them"),
        (["{}", "--grid", "8x8"], 2, "--grid 8x8: accepted is 16 columns and rows or more"),
        (["{}", "--pitch-mm", "0.2"], 2, "--pitch-mm 0.2 contradicts presses"),
        (["{}", "--pitch-mm", "1,2,3"], 2, "'1,2,3' is no pitch"),
        (["{}", "--bits", "9"], 2, "--bits 9: accepted is a whole number from 1 to 6"),
        (["{}", "--out", "mine.npy"], 2, "--out mine.npy: give the name of an .npz file"),
        (["none"], 2, "none: no presses.csv in it"),
    ],
)
def test_bad_input_is_one_line(
    folder: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    words: list[str],
    status: int,
    message: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["calibrate", *(word.format(folder) for word in words)]) == status
    (line,) = capsys.readouterr().err.splitlines()
    assert message in line
    assert list(tmp_path.iterdir()) == []
