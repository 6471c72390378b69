# SPDX-License-Identifier: Apache-2.0
"""make calibrate: its variables, files and errors; tests/device/test_calibrate.py tests the command that it runs."""

import errno
import os
import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tactile_depth.base.files import CACHE_TAG, RECORD
from tactile_depth.calibrate.fitting import fit_presses
from tactile_depth.calibrate.press_pictures import gather
from tactile_depth.calibrate.presses import to_grid
from tactile_depth.chip.camera_configuration import CameraChoice
from tactile_depth.cli import calibrate
from tactile_depth.pictures.frames import read_picture
from tactile_depth.sensor.built_in import load
from tactile_depth.sensor.calibration_file import FOLDER
from tests.ball_presses import CAMERA, PITCH, real_folder, table_rows, write_table


def test_the_variables_reach_the_fit(folder: Path, tmp_path: Path, run_command: Any) -> None:
    copied, out = shutil.copytree(folder, tmp_path / "presses"), tmp_path / "new" / "mine.npz"
    (copied / "03.png").unlink()
    words = [
        f"PRESSES={copied}",
        f"OUT={out}",
        f"PITCH={PITCH}",
        "EXPOSURE_US=8000",
        "BITS=3",
        "CAMERA=raw8",
        "BAYER=grbg",
        "CROP=0.8,1",
    ]
    status, output, (line,) = run_command("calibrate", *words)
    assert status == 0
    assert re.fullmatch(r"make calibrate: warning: \S+03\.png: no such file.*: left out", line)
    presses = to_grid(gather(copied), PITCH, choice=CameraChoice("raw8", "grbg"))
    sensor, fit = load(str(out)), fit_presses(presses, bits=3)
    for name in ("table", "coefficients", "gradient", "height_errors"):
        np.testing.assert_array_equal(getattr(sensor, name), getattr(fit.sensor, name))
    camera = sensor.camera
    assert camera is not None
    assert sensor.view == (0.8, 1)
    assert "0.8 of the width and 1 of the height of the sensor's full picture" in output
    assert (camera.rows, camera.columns, camera.exposure_us, camera.pixel_format) == (*CAMERA, 8000, "raw8")
    assert read_picture(out.with_suffix(".png")).shape[1] > 1000
    for printed in (
        fit.evaluation.summary,
        "23 presses",
        "circles found in 23 pictures",
        f"the best model is {sensor.model}",
    ):
        assert printed in output
    assert sorted(path.name for path in out.parent.iterdir()) == [
        RECORD,
        *(f"mine{end}" for end in ("-circles.csv", "-circles.html", "-circles.png", ".npz", ".png")),
    ]


def test_found_circles_replace_those_of_the_table(folder: Path, tmp_path: Path, run_command: Any) -> None:
    copied, words = shutil.copytree(folder, tmp_path / "presses"), [f"PITCH={PITCH}", "GRADIENT=quadratic"]
    assert (
        run_command("calibrate", f"PRESSES={folder}", *words, "CIRCLES=found", f"OUT={tmp_path / 'a.npz'}").status == 0
    )
    rows = [{**row, "ball_diameter_mm": row["diameter_mm"]} for row in table_rows()]
    write_table(copied, rows, ["frame", "ball_diameter_mm"])
    assert run_command("calibrate", f"PRESSES={copied}", *words, f"OUT={tmp_path / 'b.npz'}").status == 0
    found, without = load(str(tmp_path / "a.npz")), load(str(tmp_path / "b.npz"))
    assert found.models == ("quadratic",)
    np.testing.assert_array_equal(found.coefficients, without.coefficients)
    assert found.height_errors["quadratic"].mean == pytest.approx(1, abs=0.06)


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
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, run_command: Any
) -> None:
    (tmp_path / CACHE_TAG).touch()  # there all files may be replaced
    (tmp_path / "mine.npz").write_text("earlier")

    def full(*_: Any) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "mine.png")

    monkeypatch.setattr(calibrate, "draw_presses", full)
    words = [f"PRESSES={folder}", "GRADIENT=quadratic", f"OUT={tmp_path / 'mine.npz'}"]
    status, _, (line,) = run_command("calibrate", *words)
    assert status == 3
    assert "mine.png: No space left on device: free disk space" in line
    assert (tmp_path / "mine.npz").read_text() == "earlier"
    assert sorted(path.name for path in tmp_path.iterdir()) == [CACHE_TAG, "mine.npz"]


@pytest.mark.regress  # tests/test_real_fits.py compares the fit itself
def test_the_shipped_calibration_is_what_the_command_makes(tmp_path: Path, run_command: Any) -> None:
    out = tmp_path / "gelsight-mini.npz"
    assert run_command("calibrate", f"PRESSES={real_folder()}", "CROP=gs_sdk", f"OUT={out}").status == 0
    with np.load(out) as made, np.load(FOLDER / "gelsight-mini.npz") as shipped:
        assert sorted(made.files) == sorted(shipped.files)
        np.testing.assert_array_equal(made["gradient"], shipped["gradient"])
        assert made["largest_slope"] == shipped["largest_slope"]
        # Sums may be rounded differently on another machine; measured: 3e-11.
        np.testing.assert_allclose(made["coefficients"], shipped["coefficients"], atol=1e-9)
