# SPDX-License-Identifier: Apache-2.0
"""make calibrate: its files, its output, and errors for bad variables. test_fitting.py tests the fit."""

import errno
import os
import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from commands.run import draw
from commands.run.calibrate import parse, run
from tactile_depth.calibrate.fitting import fit_presses
from tactile_depth.pictures.frames import read_picture
from tactile_depth.sensor.built_in import load
from tactile_depth.sensor.calibration_file import FOLDER
from tests.ball_presses import CAMERA, PITCH, read, real_folder, table_rows, write_folder, write_table


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Any:
    return write_folder(tmp_path_factory.mktemp("ball") / "presses")


@pytest.fixture
def folder(made: Any, tmp_path: Path) -> Any:
    return Path(shutil.copytree(made, tmp_path / "presses"))


def test_the_command_writes_a_calibration_a_picture_and_a_table(
    made: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "new" / "mine.npz"
    assert run(parse([f"PRESSES={made}", f"OUT={out}", "EXPOSURE_US=8000"])) == 0
    report = capsys.readouterr()
    assert not report.err
    sensor, fit = load(str(out)), fit_presses(read(made))
    np.testing.assert_array_equal(sensor.coefficients, fit.sensor.coefficients)
    np.testing.assert_array_equal(sensor.gradient, fit.sensor.gradient)
    assert sensor.height_errors == fit.sensor.height_errors
    assert (sensor.camera.rows, sensor.camera.columns, sensor.camera.exposure_us) == (*CAMERA, 8000)  # type: ignore[union-attr]
    assert read_picture(out.with_suffix(".png")).shape[1] > 1000
    assert str(fit.evaluation) in report.out
    for words in ("24 presses fitted", "circles found in 24 pictures", "the best model is cubic"):
        assert words in report.out
    assert sorted(path.name for path in out.parent.iterdir()) == ["mine.npz", "mine.png"]


@pytest.mark.parametrize("model", ["lut", pytest.param("quadratic", marks=pytest.mark.regress)])
def test_one_model_alone_is_written_alone(made: Any, tmp_path: Path, model: Any) -> None:
    out = tmp_path / "one.npz"
    assert run(parse([f"PRESSES={made}", f"OUT={out}", f"GRADIENT={model}", "BITS=3"])) == 0
    sensor = load(str(out))
    assert sensor.models == (model,)
    assert tuple(sensor.height_errors) == tuple(sensor.fitted_slope) == (model,)
    if model == "lut":
        assert sensor.bits_per_channel == 3


def test_a_table_of_frames_and_diameters_alone_serves(folder: Path, tmp_path: Path) -> None:
    rows = [{**row, "ball_diameter_mm": row["diameter_mm"]} for row in table_rows()]
    write_table(folder, rows, ["frame", "ball_diameter_mm"])
    out = tmp_path / "found.npz"
    assert run(parse([f"PRESSES={folder}", f"PITCH={PITCH}", "GRADIENT=quadratic", f"OUT={out}"])) == 0
    assert load(str(out)).height_errors["quadratic"].mean == pytest.approx(1, abs=0.06)


def test_what_is_left_out_is_printed(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "03.png").unlink()
    assert run(parse([f"PRESSES={folder}", "GRADIENT=quadratic", f"OUT={tmp_path / 'mine.npz'}"])) == 0
    assert re.fullmatch(r"make calibrate: \S+03\.png: no such file.*: left out\n", capsys.readouterr().err)


def test_a_folder_that_is_missing_says_how_to_get_one(
    refused: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TACTILE_DATA", str(tmp_path))
    assert "rpl-cmu/gelslam" in refused("calibrate")
    assert "no presses.csv in it: " in refused("calibrate", f"PRESSES={tmp_path}", f"OUT={tmp_path / 'mine.npz'}")


@pytest.mark.parametrize(
    ("out", "reason"),
    [
        ("file/mine.npz", "/file is a file"),
        ("file/below/mine.npz", "cannot be written (Not a directory)"),
        ("folder.npz", "cannot be written (folder.npz is a folder)"),
        ("drawn.npz", "cannot be written (drawn.png is a folder)"),
        (f"{'x' * 300}.npz", "cannot be written (File name too long)"),
        ("link/mine.npz", "/link is a link to"),
    ],
)
def test_a_result_that_cannot_be_written_is_named_before_the_fit(
    tmp_path: Path, refused: Any, out: Any, reason: str
) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "folder.npz").mkdir()
    (tmp_path / "drawn.png").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    before = sorted(tmp_path.rglob("*"))
    line = refused("calibrate", f"PRESSES={tmp_path}", f"OUT={tmp_path / out}")
    assert line.startswith(f"make calibrate: OUT={tmp_path / out}")
    assert reason in line
    assert sorted(tmp_path.rglob("*")) == before


def test_a_full_disk_leaves_earlier_results(
    made: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, run_command: Any
) -> None:
    (tmp_path / "mine.npz").write_text("earlier")

    def full(*_: Any) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "mine.png")

    monkeypatch.setattr(draw, "draw_presses", full)
    words = [f"PRESSES={made}", "GRADIENT=quadratic", f"OUT={tmp_path / 'mine.npz'}"]
    status, _, (line,) = run_command("calibrate", *words)
    assert status == 3
    assert "mine.png: No space left on device: free disk space" in line
    assert (tmp_path / "mine.npz").read_text() == "earlier"
    assert [path.name for path in tmp_path.iterdir()] == ["mine.npz"]


@pytest.mark.regress  # tests/test_fitting.py compares the fit itself
def test_the_shipped_calibration_is_what_the_command_makes(tmp_path: Path) -> None:
    out = tmp_path / "gelsight-mini.npz"
    assert run(parse([f"PRESSES={real_folder()}", f"OUT={out}"])) == 0
    with np.load(out) as made, np.load(FOLDER / "gelsight-mini.npz") as shipped:
        assert sorted(made.files) == sorted(shipped.files)
        np.testing.assert_array_equal(made["gradient"], shipped["gradient"])
        assert made["largest_slope"] == shipped["largest_slope"]
        # Sums may be rounded differently on another machine; measured: 3e-11.
        np.testing.assert_allclose(made["coefficients"], shipped["coefficients"], atol=1e-9)
