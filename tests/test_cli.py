# SPDX-License-Identifier: Apache-2.0
"""Command `tactile-depth depth`: its files hold the results of the package, and bad input gives one line."""

import json
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
from PIL import Image

import tactile_depth as td
from tactile_depth.base.files import RECORD
from tactile_depth.base.interruption import SIGNALS
from tactile_depth.cli.main import main
from tactile_depth.sensor.presets import THRESHOLD_MM
from tests.drawn_light import as_picture, no_contact, pressed
from tests.real_data import FOLDER, needs_real_data

GRID = ["--grid", "32x24"]
WAIT_S = 60
MANY = 200  # pictures, so that a command lasts until a signal


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Return pictures of the sample, its background and its calibration, as files."""
    folder = tmp_path_factory.mktemp("inputs")
    sample = td.sample("ball")
    sample.sensor.save(folder / "sensor.npz")
    Image.fromarray(sample.image).save(folder / "press.png")
    Image.fromarray(sample.reference).save(folder / "background.png")
    np.save(folder / "many.npy", np.repeat(sample.image[None], MANY, axis=0))
    return folder


@pytest.fixture
def arguments(inputs: Any) -> list[Any]:
    return ["--reference", f"{inputs}/background.png", "--calibration", f"{inputs}/sensor.npz", *GRID]


@pytest.fixture
def depth(tmp_path: Path, inputs: Any, arguments: Any, capsys: pytest.CaptureFixture[str]) -> Any:
    """Return a function that writes the depth of pictures, by default of the press, and returns what is printed."""

    def run(*options: Any, pictures: Any = None, out: Any = tmp_path, status: int = 0) -> Any:
        words = [*(pictures or [f"{inputs}/press.png"]), "--out", out, *arguments, *options]
        assert main(["depth", *map(str, words)]) == status
        return capsys.readouterr()

    return run


def expected(inputs: Any, **choices: Any) -> Any:
    pipeline = td.Pipeline(td.load(inputs / "sensor.npz"), inputs / "background.png", grid=(24, 32), **choices)
    return pipeline(inputs / "press.png")


def test_the_report_has_the_time_of_capture_that_a_picture_holds(tmp_path: Path, inputs: Any, depth: Any) -> None:
    for name, zone in (("timed.png", {0x9011: "+02:00"}), ("vague.png", {})):
        with Image.open(inputs / "press.png") as picture:
            exif = picture.getexif()
            exif[0x8769] = {0x9003: "2026:11:28 22:00:00", 0x9291: "25", **zone}
            picture.save(tmp_path / name, exif=exif)
    depth(pictures=[f"{tmp_path}/timed.png", f"{tmp_path}/vague.png"], out=tmp_path / "out")
    pictures = json.loads((tmp_path / "out" / "report.json").read_text())["pictures"]
    assert [each["captured_at"] for each in pictures] == [1795896000.25, None]


def read_ply(path: Path) -> tuple[Any, ...]:
    """Return vertices and faces of a binary mesh, read as its header describes."""
    header, _, body = path.read_bytes().partition(b"end_header\n")
    counts = {line.split()[1]: int(line.split()[2]) for line in header.decode().splitlines() if "element" in line}
    assert b"format binary_little_endian 1.0" in header
    vertices = np.frombuffer(body, "<f4", 3 * counts["vertex"]).reshape(-1, 3)
    faces = np.frombuffer(body[vertices.nbytes :], [("count", "u1"), ("corners", "<i4", 3)])
    assert len(faces) == counts["face"]
    return vertices, faces


# Files.


def test_the_files_hold_the_height_of_the_pipeline(tmp_path: Path, inputs: Any, depth: Any) -> None:
    depth()
    height = expected(inputs).height_mm
    depth_mm = np.load(tmp_path / "depth_mm.npy")
    assert depth_mm.dtype == np.float32
    np.testing.assert_array_equal(depth_mm, height.astype(np.float32))
    with Image.open(tmp_path / "depth_um.png") as picture:
        assert (tmp_path / "depth_um.png").read_bytes()[24:26] == bytes([16, 0]), "16 bits of grey"
        assert picture.text["Description"].endswith("in micrometres, which viewers show black")  # type: ignore[attr-defined]
        np.testing.assert_array_equal(np.array(picture), np.maximum(np.rint(1000 * height), 0))
    vertices, faces = read_ply(tmp_path / "depth.ply")
    np.testing.assert_array_equal(vertices[:, 2].reshape(24, 32), depth_mm)
    pitch = expected(inputs).pixel_pitch_mm
    np.testing.assert_allclose(vertices[[0, 31, -1], :2], np.array([[0, 0], [31, 0], [31, -23]]) * pitch, rtol=1e-6)
    assert len(faces) == 2 * 23 * 31
    with Image.open(tmp_path / "overview.png") as picture:
        assert picture.size[0] > 1000
    files = {path.name for path in tmp_path.iterdir()}
    assert files == {RECORD, "depth_mm.npy", "depth_um.png", "depth.ply", "overview.png", "report.json"}


def test_the_report_describes_the_result(tmp_path: Path, inputs: Any, depth: Any) -> None:
    printed = depth().out
    report, result = json.loads((tmp_path / "report.json").read_text()), expected(inputs)
    assert report["grid"] == {"rows": 24, "columns": 32}
    assert report["pixel_pitch_mm"] == result.pixel_pitch_mm
    assert report["calibration"] == f"{inputs}/sensor.npz"
    (picture,) = report["pictures"]
    assert picture["peak_height_mm"] == result.height_mm.max()
    contact = picture["contact"]
    assert contact["touching"]
    (listed,) = picture["contacts"]
    assert listed["peak_height_mm"] == result.contacts[0].peak_height_mm == pytest.approx(result.height_mm.max())
    assert {**contact, "peak_height_mm": listed["peak_height_mm"]} == {"touching": True, **listed}
    assert contact["area_mm2"] == result.contact.area_mm2
    assert contact["volume_mm3"] == result.contact.volume_mm3
    assert contact["centroid_px"] == list(result.contact.centroid_px)
    assert (picture["dark_pixels"], picture["outside_pixels"], picture["saturations"]) == (0, 0, {})
    assert sorted(report["files"]) == sorted(path.name for path in tmp_path.iterdir() if path.name != RECORD)
    assert "grid: 32 x 24 pixels of 0.6" in printed
    assert f"peak height {result.height_mm.max():.2f} mm, contact area {result.contact.area_mm2:.1f} mm2" in printed
    assert "error of the calibration not measured" in printed


@pytest.mark.parametrize(
    ("options", "choices"),
    [
        (["--arithmetic", "float"], {"arithmetic": "float"}),
        (["--threshold-mm", "0.5"], {"threshold_mm": 0.5}),
        (["--model", "lut"], {"model": "lut"}),
        (["--no-zero-offset"], {"zero_offset": False}),
    ],
    ids=lambda value: value[0] if isinstance(value, list) else "",
)
def test_options_reach_the_pipeline(tmp_path: Path, inputs: Any, depth: Any, options: Any, choices: Any) -> None:
    depth(*options)
    result = expected(inputs, **choices)
    np.testing.assert_array_equal(np.load(tmp_path / "depth_mm.npy"), result.height_mm.astype(np.float32))
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["threshold_mm"] == choices.get("threshold_mm", THRESHOLD_MM)
    assert report["zero_offset"] == choices.get("zero_offset", True)


def test_a_name_with_a_line_break_is_drawn(tmp_path: Path, inputs: Any, arguments: Any) -> None:
    name = tmp_path / "a\nb\r\tc.png"
    name.write_bytes((inputs / "press.png").read_bytes())
    assert main(["depth", str(name), *arguments, "--out", f"{tmp_path}/out"]) == 0
    assert json.loads((tmp_path / "out" / "report.json").read_text())["pictures"][0]["picture"] == str(name)


def test_portrait_pictures_are_refused_until_they_are_rotated(
    tmp_path: Path, inputs: Any, arguments: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "portrait"
    folder.mkdir()
    for name in ("press.png", "background.png"):
        Image.fromarray(np.rot90(np.asarray(Image.open(inputs / name)), -1)).save(folder / name)
    words = [f"{folder}/press.png", *arguments, "--reference", f"{folder}/background.png", "--out", f"{tmp_path}/out"]
    assert main(["depth", *words]) == 2
    refusal = capsys.readouterr().err
    assert "rotate them by 90 or 270 degrees" in refusal
    assert "or, if the calibration was made from pictures as these, correct its `camera_size`" in refusal
    assert main(["depth", *words, "--rotate", "90"]) == 0
    heights = np.load(tmp_path / "out" / "depth_mm.npy")
    np.testing.assert_array_equal(heights, expected(inputs).height_mm.astype(np.float32))


def test_several_pictures_share_one_array(tmp_path: Path, inputs: Any, depth: Any) -> None:
    depth(pictures=[f"{inputs}/press.png", f"{inputs}/background.png"])
    height = np.load(tmp_path / "depth_mm.npy")
    assert height.shape == (2, 24, 32)
    np.testing.assert_array_equal(height[0], expected(inputs).height_mm.astype(np.float32))
    report = json.loads((tmp_path / "report.json").read_text())
    assert [picture["contact"]["touching"] for picture in report["pictures"]] == [True, False]
    assert report["pictures"][1]["files"] == ["depth_um_1.png", "depth_1.ply", "overview_1.png"]
    assert sorted(report["files"]) == sorted(path.name for path in tmp_path.iterdir() if path.name != RECORD)


def test_a_second_run_removes_the_files_of_the_first_and_nothing_else(tmp_path: Path, inputs: Any, depth: Any) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    depth(pictures=[f"{inputs}/press.png"] * 2)
    depth()
    assert {path.name for path in tmp_path.iterdir()} == {
        RECORD, "notes.txt", "depth_mm.npy", "depth_um.png", "depth.ply", "overview.png", "report.json"
    }  # fmt: skip


def test_a_second_picture_of_one_name_does_not_replace_the_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, inputs: Any, arguments: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("1: press.png", "other/1: press.png", "pressed/a.png", "pressed/b.png"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes((inputs / "press.png").read_bytes())
    again = ("1: press.png", 0), ("./1: press.png", 0), ("pressed", 0), ("pressed/", 0)
    for picture, status in (*again, ("other/1: press.png", 2)):
        assert main(["depth", picture, *arguments]) == status, picture
    assert "1: press-depth holds results of ./1: press.png: give another folder as --out" in capsys.readouterr().err


def test_empty_paths_are_refused(inputs: Any, arguments: Any, capsys: pytest.CaptureFixture[str]) -> None:
    """Variables of a shell that are not set would name the present folder."""
    press = [f"{inputs}/press.png", *arguments]
    for words in (["", *arguments], [*press, "--reference", ""], [*press, "--out", ""]):
        assert main(["depth", *words]) == 2
        assert "is empty: give a" in capsys.readouterr().err


def test_a_file_of_others_is_not_replaced(tmp_path: Path, inputs: Any, depth: Any) -> None:
    (tmp_path / "depth.ply").write_text("mine")
    reason = "depth.ply is there and was not written by an earlier run, or was changed since"
    assert depth(status=2).err == f"tactile-depth: --out {tmp_path}: {reason}: move it away or give another name\n"
    assert [path.read_text() for path in tmp_path.iterdir()] == ["mine"]


def test_a_folder_with_the_name_of_a_result_is_not_replaced(tmp_path: Path, depth: Any) -> None:
    mine = tmp_path / "overview.png" / "mine.txt"
    mine.parent.mkdir()
    mine.write_text("mine")
    reason = "cannot be written (overview.png in it is a folder): remove it or give another"
    assert depth(status=2).err == f"tactile-depth: --out {tmp_path} {reason}\n"
    assert sorted(tmp_path.rglob("*")) == [mine.parent, mine]


def test_a_folder_with_the_name_of_an_earlier_result_stays(tmp_path: Path, inputs: Any, depth: Any) -> None:
    depth(pictures=[f"{inputs}/press.png"] * 2)
    (tmp_path / "depth_0.ply").unlink()
    (tmp_path / "depth_0.ply").mkdir()
    depth()
    assert (tmp_path / "depth_0.ply").is_dir()
    assert not (tmp_path / "depth_1.ply").exists()


@pytest.mark.parametrize(
    ("picture", "out"),
    [
        ("press.png", "press-depth"),
        ("press.5.1mm.PNG", "press.5.1mm-depth"),
        ("shot.5", "shot.5-depth"),  # a PNG without a suffix of its own
        ("5.1mm/press.png", "press-depth"),
        ("5.1mm", "5.1mm-depth"),
        ("5.2.png", "5.2.png-depth"),  # a folder
    ],
)
def test_the_results_lie_in_the_current_folder_by_default(
    tmp_path: Path, inputs: Any, arguments: Any, monkeypatch: pytest.MonkeyPatch, picture: str, out: str
) -> None:
    monkeypatch.chdir(tmp_path)
    file = Path(picture, "0.png") if picture in ("5.1mm", "5.2.png") else Path(picture)
    file.parent.mkdir(exist_ok=True)
    file.write_bytes((inputs / "press.png").read_bytes())
    assert main(["depth", picture, *arguments]) == 0
    assert (tmp_path / out / "depth_mm.npy").is_file()


def test_nothing_is_written_when_one_picture_is_bad(tmp_path: Path, inputs: Any, depth: Any) -> None:
    narrow = tmp_path / "narrow.png"
    Image.new("RGB", (100, 240)).save(narrow)
    printed = depth(pictures=[f"{inputs}/press.png", narrow], out=tmp_path / "out", status=2)
    assert not (tmp_path / "out").exists()
    assert f"tactile-depth: {narrow}: 100 x 240 pixels" in printed.err


# Choice of the calibration.


@pytest.fixture(scope="module")
def mini(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Return a picture without contact of the sensor gelsight-mini, drawn by its calibration, the same rotated, and
    one with less blue."""
    folder = tmp_path_factory.mktemp("mini")
    picture = no_contact(td.load("gelsight-mini"))
    Image.fromarray(picture).save(folder / "background.png")
    Image.fromarray(np.rot90(picture, 2)).save(folder / "rotated.png")
    Image.fromarray(picture // np.array((1, 1, 3), np.uint8)).save(folder / "yellow.png")
    return folder


def test_the_calibration_is_found_by_the_reference_and_named(
    tmp_path: Path, mini: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    picture = f"{mini}/background.png"
    assert main(["depth", picture, "--reference", picture, "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr()
    message = "calibration: gelsight-mini: the reference looks like it; --calibration names another"
    assert printed.out.splitlines()[0] == message
    assert "grid: 128 x 96 pixels of 0.1585 mm" in printed.out
    assert "no contact above 0.07 mm" in printed.out
    assert not printed.err
    report = json.loads((tmp_path / "report.json").read_text())
    assert (report["calibration"], report["calibration_named"]) == ("gelsight-mini", False)
    assert 0.03 < report["calibration_error"]["relative"] < 0.05


def test_a_reference_of_no_known_sensor_needs_a_calibration(
    tmp_path: Path, mini: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    picture = f"{mini}/rotated.png"
    assert main(["depth", picture, "--reference", picture, "--out", f"{tmp_path}/out"]) == 2
    printed = capsys.readouterr().err
    assert "accepted are 12 %, but it is rotated by 180 degrees" in printed
    assert "give the --calibration of the sensor that took it" in printed
    assert not (tmp_path / "out").exists()


def test_a_named_calibration_with_another_reference_is_used_with_a_warning(
    tmp_path: Path, mini: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    picture = f"{mini}/yellow.png"
    named = ["--calibration", "gelsight-mini"]
    assert main(["depth", picture, "--reference", picture, "--out", str(tmp_path), *GRID, *named]) == 0
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("tactile-depth: warning: --reference: it does not look like the sensor of gelsight-mini")
    assert json.loads((tmp_path / "report.json").read_text())["warnings"] == [line.removeprefix(
        "tactile-depth: warning: "
    )]  # fmt: skip


def test_a_warning_names_its_picture_and_leaves_out_the_error(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mini = td.load("gelsight-mini")
    across = np.linspace(0.95, 1.05, 320)[None, :, None]
    Image.fromarray(no_contact(mini)).save(tmp_path / "background.png")
    Image.fromarray(as_picture(pressed(mini) * across)).save(tmp_path / "press.png")
    pictures = [f"{tmp_path}/press.png", "--reference", f"{tmp_path}/background.png", "--out", f"{tmp_path}/out"]
    assert main(["depth", *pictures]) == 0
    printed = capsys.readouterr()
    assert printed.err.startswith(f"tactile-depth: warning: {tmp_path}/press.png: its light changes across it by")
    assert "uncertain, as the warnings say" in printed.out
    assert "+-" not in printed.out
    (described,) = json.loads((tmp_path / "out" / "report.json").read_text())["pictures"]
    assert described["warnings"][0].startswith(f"{tmp_path}/press.png: its light changes across it by")


def test_a_name_that_the_encoding_of_the_terminal_lacks_is_printed_with_replacements(
    tmp_path: Path, inputs: Any
) -> None:
    (tmp_path / "\u6d4b.png").write_bytes((inputs / "press.png").read_bytes())
    options = [
        "--reference",
        f"{inputs}/background.png",
        "--calibration",
        f"{inputs}/sensor.npz",
        "--out",
        "out",
        *GRID,
    ]
    command = [sys.executable, "-m", "tactile_depth.cli", "depth", "\u6d4b.png", *options]
    environment = {**os.environ, "PYTHONIOENCODING": "cp1252"}
    run = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, timeout=WAIT_S, check=False)
    assert run.returncode == 0, run.stderr
    assert b"?.png: peak height" in run.stdout


@needs_real_data
@pytest.mark.parametrize(("press", "height"), [("12.png", "peak height 0.78 +- 0.03 mm"), ("3.png", "")])
def test_a_real_press_beside_the_middle_square_says_that_its_error_was_not_measured(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], press: str, height: str
) -> None:
    data = FOLDER / "gelslam"
    picture, reference = data / "9.500mm" / press, data / "background.png"
    assert main(["depth", str(picture), "--reference", str(reference), "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    (described,) = json.loads((tmp_path / "report.json").read_text())["pictures"]
    is_central = press == "12.png"
    assert described["contact"]["is_central"] is is_central
    leaves = "the contact leaves the middle square, where the error was measured; outside it the error is larger"
    assert (leaves not in printed) == is_central
    assert height in printed


# Bad input: one line and exit status 2.


PRESS = ["depth", "{press}", "--reference", "{ref}"]
CALIBRATED = [*PRESS, "--calibration", "{npz}"]


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ([], "the following arguments are required: COMMAND: see `tactile-depth --help`"),
        (["height"], "invalid choice: 'height'"),
        (["depth"], "the following arguments are required: PICTURE, --reference: see `tactile-depth depth --help`"),
        (["depth", "none.png", "--reference", "none.png"], "none.png: no such file or folder"),
        ([*PRESS, "--calibration", "x.npz"], "x.npz"),
        ([*PRESS, "--grid", "32"], "'32' is no size: accepted is columns x rows"),
        ([*CALIBRATED, "--grid", "33x24"], "--grid 33x.. is not a power of two"),
        ([*PRESS, "--arithmetic", "exact"], "invalid choice: 'exact'"),
        ([*CALIBRATED, "--threshold-mm", "-1"], "--threshold-mm -1.0: acc"),
        ([*CALIBRATED, "--out", "{press}"], "{press} is a file"),
    ],
)
def test_bad_input_is_one_line(
    tmp_path: Path, inputs: Any, monkeypatch: pytest.MonkeyPatch, capsys: Any, command: Any, message: Any
) -> None:
    monkeypatch.chdir(tmp_path)
    names = {"press": f"{inputs}/press.png", "ref": f"{inputs}/background.png", "npz": f"{inputs}/sensor.npz"}
    assert main([word.format(**names) for word in command]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("tactile-depth: ")
    assert message.format(**names) in line
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("error", "status", "line"),
    [(KeyboardInterrupt, 130, "tactile-depth: interrupted\n"), (ZeroDivisionError, 3, "an error of this program")],
)
def test_an_interruption_and_an_error_of_the_program_have_a_status(
    depth: Any, monkeypatch: pytest.MonkeyPatch, error: Any, status: int, line: str
) -> None:
    monkeypatch.setattr("tactile_depth.cli.depth.make_pipeline", Mock(side_effect=error))
    assert line in depth(status=status).err


def started(words: list[str], **options: Any) -> Any:
    """Start the command with the default handling of signals."""

    def defaults() -> None:
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, signal.SIG_DFL)
        for limit, value in options.items():
            resource.setrlimit(getattr(resource, limit), (value, value))

    command = [sys.executable, "-m", "tactile_depth.cli", *words]
    return subprocess.Popen(command, stderr=subprocess.PIPE, text=True, preexec_fn=defaults)


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_a_signal_removes_the_draft(tmp_path: Path, inputs: Any, arguments: Any, name: str) -> None:
    process = started(["depth", f"{inputs}/many.npy", "--out", f"{tmp_path}/new/out", *arguments])
    deadline = time.monotonic() + WAIT_S
    while not list(tmp_path.glob("new/out/.work-*")):
        assert process.poll() is None, process.stderr.read()
        assert time.monotonic() < deadline, "the draft did not come"
        time.sleep(0.02)
    process.send_signal(getattr(signal, name))
    _, errors = process.communicate(timeout=WAIT_S)
    assert errors == f"tactile-depth: {SIGNALS[getattr(signal, name)]}\n"
    assert process.returncode == 128 + getattr(signal, name)
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_does_not_fit_ends_with_3(tmp_path: Path, inputs: Any, arguments: Any) -> None:
    """Limit the size of files, which acts like a full disk."""
    words = ["depth", f"{inputs}/press.png", "--out", f"{tmp_path}/out", *arguments]
    process = started(words, RLIMIT_FSIZE=1000)
    _, errors = process.communicate(timeout=WAIT_S)
    assert process.returncode == 3
    (line,) = errors.splitlines()
    assert line.endswith(": free disk space, or give a folder on another disk")
    assert list(tmp_path.iterdir()) == []


def test_the_version_is_that_of_the_package(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--version"])
    assert ended.value.code == 0
    assert capsys.readouterr().out == f"tactile-depth {td.__version__}\n"
