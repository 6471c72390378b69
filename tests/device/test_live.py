# SPDX-License-Identifier: Apache-2.0
"""`tactile-depth live device:..`: it shows what the device sends, and each picture is shown or counted as lost."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import tactile_depth as td
from tactile_depth.cli import live as command
from tactile_depth.cli.main import main
from tests.device.cable import setup_of
from tests.device.conftest import GRID, Plug
from tests.device.model_device import Setup
from tests.device.test_formats import require_sent
from tests.press_video import press_frames, write_inputs
from tests.test_live import counted

FRAMES = 6
MANY = 96  # pictures: that a bad line loses none of them has a probability below 0.001
WORDS = ["--grid", f"{GRID[1]}x{GRID[0]}"]


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return drawn presses as a folder of pictures, background and calibration."""
    return write_inputs(tmp_path_factory.mktemp("inputs"), FRAMES)


@pytest.fixture
def fitting(inputs: Path) -> td.Pipeline:
    return td.Pipeline(td.load(inputs / "sensor.npz"), inputs / "background.png", grid=GRID)


@pytest.fixture
def screen(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Replace the display and the check that it is installed; return the frames that were shown."""
    shown: list[tuple[int, np.ndarray | None, Any]] = []

    class Screen:
        def __init__(self, *_: Any) -> None:
            pass

        def __enter__(self) -> Screen:
            return self

        def __exit__(self, *_: Any) -> None:
            pass

        def show(self, index: int, picture: np.ndarray | None, result: Any, _: int) -> None:
            shown.append((index, picture, result))

    monkeypatch.setattr(command, "Display", Screen)
    monkeypatch.setattr(command, "load_rerun", lambda: None)
    return shown


def run(inputs: Path, *words: Any, status: int = 0) -> None:
    assert main(["live", *map(str, words), "--calibration", f"{inputs}/sensor.npz", *WORDS]) == status


def background(inputs: Path) -> list[str]:
    return ["--reference", f"{inputs}/background.png"]


def test_pictures_that_are_sent_are_shown_as_the_package_computes_them(
    inputs: Path, fitting: td.Pipeline, screen: Any, simulate: Callable[[Setup], None], capsys: Any
) -> None:
    simulate(setup_of(fitting))
    run(inputs, "device:sim", "--pictures", inputs / "presses", *background(inputs))
    images = press_frames(FRAMES)
    expected = list(fitting.stream(images))
    assert [index for index, *_ in screen] == list(range(FRAMES))
    np.testing.assert_array_equal([picture for _, picture, _ in screen], images)
    np.testing.assert_array_equal(
        [depth.height_mm for *_, depth in screen], [result.height_mm.astype(np.float32) for result in expected]
    )
    assert counted(capsys.readouterr().out) == {"read": FRAMES, "shown": FRAMES, "dropped": 0, "failed": 0}


def test_averaged_depth_of_pictures_that_are_sent(
    inputs: Path, fitting: td.Pipeline, screen: Any, simulate: Callable[[Setup], None], capsys: Any
) -> None:
    simulate(setup_of(fitting))
    words = ("--pictures", inputs / "presses", "--depth-format", "averaged", *background(inputs))
    run(inputs, "device:sim", *words)
    expected = fitting.stream(press_frames(FRAMES))
    for (*_, depth), result in zip(screen, expected, strict=True):
        require_sent(depth, result, "averaged")
    printed = capsys.readouterr().out
    pitch_mm = fitting.pixel_pitch_mm
    assert f"grid: 16 x 12 pixels of {pitch_mm:.4f} mm\ndepth: 8 x 6 pixels of {2 * pitch_mm:.4f} mm\n" in printed
    assert counted(printed)["shown"] == FRAMES


def test_the_first_pictures_become_the_reference(
    tmp_path: Path, inputs: Path, fitting: td.Pipeline, screen: Any, simulate: Callable[[Setup], None], capsys: Any
) -> None:
    no_contact, press = np.array(Image.open(inputs / "background.png")), press_frames(FRAMES)[3]
    np.save(tmp_path / "frames.npy", np.stack([no_contact] * 8 + [press]))
    simulate(setup_of(fitting))
    run(inputs, "device:sim", "--pictures", tmp_path / "frames.npy")
    (expected,) = fitting.stream([press])
    np.testing.assert_array_equal(screen[0][2].codes, expected.codes)
    assert counted(capsys.readouterr().out)["captured"] == 8


@pytest.mark.parametrize("key", ["r", "z"])
def test_keys_capture_in_the_device_from_the_pictures_that_follow(
    tmp_path: Path,
    inputs: Path,
    fitting: td.Pipeline,
    screen: Any,
    press_keys: Any,
    simulate: Callable[[Setup], None],
    capsys: Any,
    key: str,
) -> None:
    no_contact, press = np.array(Image.open(inputs / "background.png")), press_frames(FRAMES)[3]
    y, x = np.mgrid[-1:1:240j, -1:1:320j]
    light = 0.95 + 0.02 * np.stack([x, y, x * y], axis=-1)
    drifted, later = (np.rint(image * light).astype(np.uint8) for image in (no_contact, press))
    np.save(tmp_path / "frames.npy", np.stack([drifted] * 8 + [later]))
    simulate(setup_of(fitting))
    press_keys(key)
    run(inputs, "device:sim", "--pictures", tmp_path / "frames.npy", *background(inputs))
    if key == "r":
        fitting.capture_reference([drifted] * 8)
    fitting.capture_zero([drifted] * 8)
    (expected,) = fitting.stream([later])
    np.testing.assert_array_equal(screen[8][2].codes, expected.codes)
    assert "captured the" in capsys.readouterr().out


def test_pictures_without_depth_are_counted(
    tmp_path: Path, inputs: Path, fitting: td.Pipeline, screen: Any, simulate: Callable[[Setup], None], capsys: Any
) -> None:
    press = press_frames(FRAMES)[3]
    np.save(tmp_path / "frames.npy", np.stack([press, np.zeros_like(press), press]))
    simulate(setup_of(fitting))
    run(inputs, "device:sim", "--pictures", tmp_path / "frames.npy", *background(inputs))
    assert [index for index, *_ in screen] == [0, 2]
    captured = capsys.readouterr()
    assert counted(captured.out) == {"read": 3, "shown": 2, "dropped": 0, "failed": 1}
    assert "frame 1: it is black" in captured.err


def test_pictures_that_get_lost_on_the_line_are_counted(
    tmp_path: Path, inputs: Path, screen: Any, plug: Plug, capsys: Any
) -> None:
    np.save(tmp_path / "frames.npy", np.stack([press_frames(FRAMES)[3]] * MANY))
    lossy = td.Pipeline(td.load(inputs / "sensor.npz"), inputs / "background.png", grid=GRID, model="quadratic")
    cable = plug(lossy, damage={"flip": 0.03})
    run(
        inputs,
        f"device:{cable.address}",
        "--pictures",
        tmp_path / "frames.npy",
        *background(inputs),
        "--model",
        "quadratic",
    )
    counts = counted(capsys.readouterr().out)
    assert counts["read"] == MANY
    assert counts["lost"] > 0
    assert counts["shown"] == len(screen) > 0


def camera_of(pipeline: td.Pipeline, count: int) -> np.ndarray:
    """Return pictures of a device's camera on the grid: all without contact."""
    reference = pipeline.sensor.reference
    assert reference is not None
    return np.repeat(reference.reshape(1, *GRID, 3), count, axis=0)


@pytest.mark.parametrize("words", [[], ["--reference", "{}/background.png"]])
def test_a_device_with_a_camera_needs_no_pictures(
    inputs: Path, fitting: td.Pipeline, screen: Any, plug: Plug, press_keys: Any, capsys: Any, words: list[str]
) -> None:
    cable = plug(fitting, camera=camera_of(fitting, 2))
    press_keys("..r..z")
    run(inputs, f"device:{cable.address}", "--frames", 9, *(word.format(inputs) for word in words))
    printed = capsys.readouterr().out
    (expected,) = list(fitting.stream(camera_of(fitting, 1)))
    for _, picture, depth in screen[1:]:
        assert picture is None
        np.testing.assert_array_equal(depth.codes, expected.codes)
    counts = counted(printed)
    assert counts["shown"] == 9
    assert counts["failed"] == 0
    assert printed.count("captured the") == 2
    assert ("its next 8 frames become the reference" in printed) == (not words)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["device:sim"], "device:sim has no camera: give --pictures"),
        (["device:"], "device:: no device: give device:/dev/ttyUSB0"),
        (["device:/dev/none"], "there is no such port"),
        (["device:bus", "--pictures", "presses"], "device:bus is no address of a device"),
        (["presses", "--pictures", "presses"], "--pictures presses goes with a device"),
        (["device:sim", "--pictures", "none"], "none: no such source"),
        (["presses", "--depth-format", "averaged"], "--depth-format averaged goes with a device: omit it"),
        (["device:uio", "--depth-format", "16-bit"], "--depth-format 16-bit: uio has depth in words alone"),
        (["device:sim", "--depth-format", "float"], "choose from 'words', '16-bit', 'averaged'"),
        (["device:sim", "--pictures", "presses", "--arithmetic", "float"], "--arithmetic float: a device has"),
    ],
)
def test_bad_input_is_one_line(
    inputs: Path, screen: Any, monkeypatch: pytest.MonkeyPatch, capsys: Any, words: list[str], message: str
) -> None:
    monkeypatch.chdir(inputs)
    run(inputs, *words, *background(inputs), status=2)
    (line,) = capsys.readouterr().err.splitlines()
    assert message in line


def test_a_device_with_a_camera_needs_a_calibration(screen: Any, capsys: Any) -> None:
    assert main(["live", "device:/dev/ttyUSB0"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "give --calibration NAME_OR_FILE" in line


def test_a_device_that_is_unplugged_ends_it_with_one_line(
    inputs: Path, fitting: td.Pipeline, screen: Any, plug: Plug, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    cable = plug(fitting, camera=camera_of(fitting, 2))
    show = command.Display.show

    def unplug(self: Any, *shot: Any) -> None:
        show(self, *shot)
        if len(screen) == 3:
            cable.unplug()

    monkeypatch.setattr(command.Display, "show", unplug)
    run(inputs, f"device:{cable.address}", *background(inputs), status=3)
    captured = capsys.readouterr()
    warned, line = captured.err.splitlines()
    assert "not from the device's own camera" in warned
    assert "is gone: plug the device in again" in line
    assert counted(captured.out)["shown"] >= 3
