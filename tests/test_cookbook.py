# SPDX-License-Identifier: Apache-2.0
"""Every program of docs/cookbook.md runs, on drawn pictures; the device is the model of one."""

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import tactile_depth as td
from commands.common.repository import ROOT
from tests.device.cable import Cable, setup_of

PAGE = ROOT / "docs" / "cookbook.md"
RECIPES = dict(re.findall(r"^## (.*?)$.*?^```python\n(.*?)^```", PAGE.read_text(), re.MULTILINE | re.DOTALL))
Run = Callable[..., list[str]]


@pytest.fixture(scope="module")
def sample() -> td.Sample:
    return td.sample("ball")


@pytest.fixture
def run(sample: td.Sample, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Return a function that runs a recipe among drawn pictures, with names of its own, and returns what it prints."""
    for name in ("background", "left-background", "right-background", "press", "presses/2", "presses/12"):
        file = tmp_path / f"{name}.png"
        file.parent.mkdir(exist_ok=True)
        untouched = "background" in name or name == "presses/2"
        Image.fromarray(sample.reference if untouched else sample.image).save(file)
    np.save(tmp_path / "frames.npy", np.array([sample.reference, sample.image]))
    for name in ("left", "right"):
        sample.sensor.save(tmp_path / f"{name}.npz")
    monkeypatch.chdir(tmp_path)

    def run(recipe: str, address: str = "", **names: Any) -> list[str]:
        text = RECIPES[recipe].replace('td.load("gelsight-mini")', "sensor").replace("/dev/ttyUSB0", address)
        exec(text, {"sensor": sample.sensor, **names})
        return capsys.readouterr().out.splitlines()

    return run


def camera(sample: td.Sample) -> Iterator[np.ndarray]:
    return iter([sample.reference, sample.image])


def test_every_recipe_has_a_test() -> None:
    tests = "".join(name for name in globals() if name.startswith("test_"))
    assert [name for name in RECIPES if re.sub(r"\W", "_", name).lower() not in tests] == []
    assert PAGE.read_text().count("```python") == len(RECIPES)


def test_a_folder_of_pictures(run: Run) -> None:
    untouched, pressed = run("A folder of pictures")
    assert untouched.startswith("0 0.0")
    assert untouched.endswith(" 0.0 mm2")
    assert re.fullmatch(r"1 \d\.\d\d mm, [1-9]\d*\.\d mm2", pressed)


def test_a_batch_saved_in_mm(run: Run, sample: td.Sample) -> None:
    run("A batch saved in mm")
    heights = np.load("height_mm.npy")
    assert heights.dtype == np.float32
    assert heights.shape[0] == 2
    assert heights[1].max() == pytest.approx(sample.height_mm.max(), rel=0.1)


def test_contact_in_a_robot_s_loop(run: Run, sample: td.Sample) -> None:
    grasped: list[tuple[float, float, float]] = []
    run("Contact in a robot's loop", camera=camera(sample), grasp=lambda *values: grasped.append(values))
    ((height_mm, *_),) = grasped
    assert height_mm == pytest.approx(sample.height_mm.max(), rel=0.1)


def test_a_recording(run: Run, sample: td.Sample) -> None:
    lines = run("A recording", camera=camera(sample))
    (before, low), (after, high) = ([float(word) for word in line.split()] for line in lines)
    assert before <= after
    assert low < high


def test_two_fingers(run: Run, sample: td.Sample) -> None:
    lines = run("Two fingers", left_camera=camera(sample), right_camera=reversed(list(camera(sample))))
    assert lines[0].startswith("['0.00 mm', ")
    assert lines[1].endswith(", '0.00 mm']")


def test_a_device(run: Run, sample: td.Sample, tmp_path: Path) -> None:
    pytest.importorskip("serial", reason="pyserial is missing: install the extra [serial]")
    pipeline = td.Pipeline(sample.sensor, reference=sample.reference, crop="none")
    cable = Cable(tmp_path / "port", setup_of(pipeline))
    try:
        (line,) = run("A device", address=cable.address)
    finally:
        cable.unplug()
    assert line == f"{pipeline(sample.image).height_mm.max():.2f} mm True"
