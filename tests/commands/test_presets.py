# SPDX-License-Identifier: Apache-2.0
"""Presets: what a command begins with, what variables make of it, and what equals it in Python, as pages say."""

import json
import re
import shlex
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

import tactile_depth as td
from commands.common import run_request, variables
from commands.common.repository import ROOT
from commands.hardware import fpga, synth, synthesis, wrapped
from commands.run import sim
from commands.study import tune
from commands.study.tune_search import Widths
from tactile_depth.base.errors import InputError
from tactile_depth.chip.choices import Number
from tactile_depth.chip.configuration import DEFAULTS, NUMBERS, Configuration
from tactile_depth.chip.tactile_depth import default_parameters, top_parameters
from tactile_depth.depth.pipeline import Pipeline
from tactile_depth.sensor.built_in import load
from tactile_depth.sensor.presets import PRESETS, SENSOR
from tests.drawn_light import no_contact

SIZES: dict[str, tuple[int, int]] = {
    "": (96, 128),
    "N=64": (64, 64),
    "ROWS=48": (48, 128),
    "COLS=64": (96, 64),
    "N=64 ROWS=48": (48, 64),
    "SOLVER=spectral": (128, 128),
    "SOLVER=spectral COLS=64": (64, 64),
    "SOLVER=spectral N=32": (32, 32),
}
WINNERS: dict[str, Any] = {
    "SOLVER=spectral": ("solver", "spectral"),
    "BOUNDARY=dirichlet": ("boundary", "dirichlet"),
    "GRADIENT=lut": ("gradient", "lut"),
    "CALIBRATION=synthetic": ("calibration", "synthetic"),
    "CALIBRATION=mine.npz": ("gradient", ""),
    "REFERENCE=mine.png": ("zero", "mine.png"),
    "REFERENCE=mine.png ZERO=flat": ("zero", "flat"),
}


def parsed(words: str, preset: str = "sensor", frames: str = "") -> run_request.Request:
    return run_request.parse(words.split(), (*run_request.ACCEPTED, *run_request.CAMERA), preset, frames)


def background(folder: Path) -> Path:
    """Write a drawn picture without contact of the preset's sensor, and return its path."""
    picture = folder / "background.png"
    Image.fromarray(no_contact(load(SENSOR.calibration))).save(picture)
    return picture


def test_published_is_the_default_of_the_package_of_the_rtl() -> None:
    request = run_request.parse([])
    config = run_request.configure(request, run_request.load_sensor(request))
    assert request.preset == "published"
    assert top_parameters(config) == default_parameters()


def test_sensor_is_the_default_of_the_python_package(tmp_path: Path) -> None:
    _, _, config = synthesis.design(parsed(""))
    assert config == Pipeline(load(SENSOR.calibration), reference=background(tmp_path)).config


def pipelines(page: str) -> list[tuple[str, str]]:
    """Return the calls of td.Pipeline without a grid in a page, in order, and what a comment says of each."""
    calls = re.findall(r"^ *pipeline = (td\.Pipeline\((?:.|\n)*?\))(?: *# (.*))?$", page, re.MULTILINE)
    return [(re.sub(r"\s+", " ", call), comment) for call, comment in calls if "grid=" not in call]


def test_the_page_of_a_board_has_the_pipeline_of_each_preset(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    background(tmp_path)
    monkeypatch.chdir(tmp_path)
    of_presets = pipelines((ROOT / "docs" / "cable.md").read_text())
    assert [words for _, words in of_presets] == ["PRESET=sensor", "PRESET=chip"]
    for call, words in of_presets:
        assert eval(call, {"td": td}).config == synthesis.design(parsed(words))[2]


@pytest.mark.parametrize("page", ["README.md", "docs/integrate.md"])
def test_a_module_takes_the_tables_of_the_pipeline_above_it(
    page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    background(tmp_path)
    monkeypatch.chdir(tmp_path)
    before, _, after = (ROOT / page).read_text().partition('pipeline.hardware("hardware")')
    call, _ = pipelines(before)[-1]
    (words,) = re.findall(r"^    make wrap (.*?)(?: *#.*)?$", after, re.MULTILINE)[:1]
    chosen = " ".join(word for word in shlex.split(words) if not word.startswith(("NAME=", "OUT=", "TABLES=")))
    assert eval(call, {"td": td}).config == synthesis.design(parsed(chosen, wrapped.PRESET))[2]


@pytest.mark.parametrize(("words", "size"), SIZES.items())
def test_the_grid_of_sensor(words: str, size: tuple[int, int]) -> None:
    request = parsed(words)
    assert (request.rows, request.columns) == size
    run_request.check_grid(request)


@pytest.mark.parametrize(("words", "expected"), WINNERS.items())
def test_a_variable_that_is_given_wins(words: str, expected: tuple[str, str]) -> None:
    name, value = expected
    assert getattr(parsed(words), name) == value


def test_a_drawn_scene_is_of_the_drawn_sensor() -> None:
    request = parsed("FRAMES=ball")
    assert (request.calibration, request.reference, request.zero) == ("synthetic", "flat", "flat")
    _, _, config = synthesis.design(request)
    assert (config.rows, config.columns, config.gradient_model, config.zero_offset) == (96, 128, "cubic", True)


def test_pictures_need_a_reference(tmp_path: Path) -> None:
    request = parsed(f"FRAMES={background(tmp_path)}")
    assert (request.calibration, request.reference, request.zero) == (SENSOR.calibration, None, None)
    with pytest.raises(InputError, match="reference"):
        synthesis.design(request)


def test_a_configuration_file_names_a_preset(tmp_path: Path) -> None:
    file = tmp_path / "config.json"
    file.write_text(json.dumps({"PRESET": "sensor", "COLS": 64}))
    request = run_request.parse([f"CONFIG={file}"])
    assert (request.preset, request.solver, request.columns) == ("sensor", "tridiagonal", 64)
    assert run_request.parse([f"CONFIG={file}", "PRESET=published"]).solver == "spectral"


def test_a_number_that_is_not_searched_has_its_own_folder_and_survives_tune(monkeypatch: pytest.MonkeyPatch) -> None:
    field, usual = "bits_per_channel", Configuration.bits_per_channel
    added = {field: Number(meaning="bits of a colour", accepted=(3, 5)).of(field)}
    for module in (run_request, tune):
        monkeypatch.setattr(module, "NUMBERS", NUMBERS | added)
    monkeypatch.setattr(run_request, "DEFAULTS", DEFAULTS | {field: usual})
    names = [run_request.words_of(Configuration(bits_per_channel=bits)) for bits in (usual, usual + 1)]
    assert names == ["d24-c18", "d24-c18-bits_per_channel5"]
    request = run_request.of_values({"BITS_PER_CHANNEL": "5"}, (*tune.OF_SIM, "BITS_PER_CHANNEL"), "sensor")
    file = tune.config_file(request, Widths("spectral", 15, 12))
    assert (file["BITS_PER_CHANNEL"], file["DATA_WIDTH"], file["GAIN_WIDTH"]) == (5, 15, 24)


def test_an_unknown_preset_is_refused() -> None:
    with pytest.raises(InputError, match=f"PRESET=real is unknown: accepted are {', '.join(PRESETS)}"):
        run_request.parse(["PRESET=real"])


def test_the_preset_of_each_command() -> None:
    assert variables.read(synth.SynthRun, []).request.preset == "sensor"
    assert fpga.request_of({"TARGET": "ulx3s"}).design.preset == "chip"
    assert tune.choices({})[0].preset == "sensor"
    assert run_request.parse([]).preset == "published"


def test_the_first_line_names_the_preset(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert sim.run(run_request.parse(["N=16", "SIM=icarus", f"OUT={tmp_path}"])) == 0
    first = capsys.readouterr().out.splitlines()[0]
    assert first == "preset published: spectral, dirichlet, 16 x 16, lut"
