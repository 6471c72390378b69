# SPDX-License-Identifier: Apache-2.0
"""The same words build the same hardware: `make wrap`, the generator of FuseSoC, `Pipeline.hardware`, `make fpga`."""

import json
import shlex
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml
from PIL import Image

from commands.common import wrapper
from commands.hardware import ecp5, fpga, fusesoc, wrapped, yosys
from tactile_depth.base.files import RECORD
from tactile_depth.chip.limits import can_check
from tactile_depth.chip.rom_files import table_files
from tactile_depth.depth.pipeline import Pipeline
from tactile_depth.sensor.built_in import load
from tactile_depth.sensor.presets import PRESETS
from tests.drawn_light import no_contact

WORDS = (
    "",
    "N=16",
    "REFERENCE",
    "N=16 REFERENCE",
    "PRESET=sensor N=32 REFERENCE",
    "PRESET=published N=16",
    "PRESET=published N=32 CALIBRATION=gelsight-mini REFERENCE",
    "CALIBRATION=synthetic N=16 REFERENCE",
)
SIZES = ((240, 320), (480, 642))  # of the calibrated camera, and a larger one of nearly the same aspect ratio
WRITTEN = ("*.hex", "*.crc", "*.json", "*.h")


@pytest.fixture(scope="module", params=SIZES, ids=lambda size: f"{size[1]}x{size[0]}")
def picture(request: Any, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Draw a picture without contact of the presets' sensor, and return its path."""
    path = tmp_path_factory.mktemp("pictures") / "background of mine.png"
    rows, columns = request.param
    Image.fromarray(no_contact(load("gelsight-mini"))).resize((columns, rows)).save(path)
    return path


def words_of(text: str, picture: Path) -> dict[str, str]:
    words = dict(word.partition("=")[::2] for word in text.split())
    return words | ({"REFERENCE": str(picture)} if "REFERENCE" in words else {})


def files_of(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for kind in WRITTEN for path in folder.glob(kind) if path.name != RECORD}


def of_fusesoc(words: dict[str, str], folder: Path) -> dict[str, bytes]:
    folder.mkdir()
    (folder / "wanted.yml").write_text(yaml.safe_dump({"vlnv": "::tables:0", "parameters": {"NAME": "mine", **words}}))
    fusesoc.generate(folder / "wanted.yml", folder)
    return files_of(folder)


def pipeline_of(words: dict[str, str]) -> Pipeline:
    """Return the pipeline whose arguments mean the same as words of make."""
    preset = PRESETS[words.get("PRESET", "chip")]
    rows, columns = (int(words["N"]),) * 2 if "N" in words else preset.grid
    return Pipeline(
        load(words.get("CALIBRATION", preset.calibration)),
        words.get("REFERENCE"),
        grid=(rows, columns),
        solver=preset.solver,
        boundary=preset.boundary,
        model=preset.model if preset.zero_offset else "",
        zero_offset=preset.zero_offset,
        light_gains=None if preset.light_gains else False,
        parity=preset.parity,
        self_check=preset.self_check and can_check(columns, 1),
        **preset.words,  # type: ignore[arg-type]
    )


@pytest.mark.parametrize("text", WORDS)
def test_the_same_words_write_the_same_files(
    run_command: Callable[..., Any], capsys: pytest.CaptureFixture[str], tmp_path: Path, picture: Path, text: str
) -> None:
    words = words_of(text, picture)
    ended = run_command("wrap", "NAME=mine", f"OUT={tmp_path / 'wrap'}", *map("=".join, words.items()))
    assert ended.status == 0
    of_wrap = files_of(tmp_path / "wrap")
    assert {"parameters.json", "tactile_depth_tables.h"} < of_wrap.keys()
    assert of_fusesoc(words, tmp_path / "fusesoc") == of_wrap
    from_fusesoc = capsys.readouterr().out.splitlines()[-1]
    assert from_fusesoc == ended.output.splitlines()[1]  # the line of all words
    fields = json.loads(of_wrap["parameters.json"])["fields"]
    modules = {(tmp_path / door / "tactile_depth_mine.sv").read_text() for door in ("wrap", "fusesoc")}
    assert modules == {wrapper.wrapper("mine", fields, folder) for folder in ("./", "mine/")}
    if "REFERENCE" in words or words.get("PRESET") == "published":
        pipeline_of(words).hardware(tmp_path / "hardware")
        assert files_of(tmp_path / "hardware") == of_wrap
        assert capsys.readouterr().out.rpartition(": ")[2] == from_fusesoc.rpartition(": ")[2] + "\n"


PIPELINES: dict[str, dict[str, Any]] = {
    "defaults": {},
    "words": {"grid": (30, 64), "data_width": 20, "depth_range_mm": 1.7, "model": "quadratic", "light_gains": False},
    "table": {"grid": (32, 32), "solver": "spectral", "boundary": "dirichlet", "model": "lut", "zero_offset": False},
    "cut": {"grid": (16, 16), "crop": 0.6, "gain_width": 18, "depth_range_mm": 1 / 3},
}


@pytest.mark.parametrize("arguments", PIPELINES.values(), ids=PIPELINES)
def test_the_words_of_a_pipeline_give_its_hardware(
    run_command: Callable[..., Any],
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    picture: Path,
    arguments: dict[str, Any],
) -> None:
    pipeline = Pipeline(load("gelsight-mini"), picture, **arguments)
    pipeline.hardware(tmp_path / "hardware")
    words = shlex.split(capsys.readouterr().out.partition(": ")[2])
    assert run_command("wrap", "NAME=mine", f"OUT={tmp_path / 'wrap'}", *words).status == 0
    assert files_of(tmp_path / "wrap") == files_of(tmp_path / "hardware")


def test_what_no_word_names_is_said(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    array = no_contact(load("gelsight-mini"))
    pipeline = Pipeline(load("gelsight-mini").centred_at(0.1, 0), array, grid=(16, 16))
    pipeline.hardware(tmp_path)
    printed = capsys.readouterr().out
    for word in ("CALIBRATION=<the file", "REFERENCE=<the picture of", "ZERO=<the pictures of"):
        assert word in printed
    pipeline.capture_reference(array)
    pipeline.hardware(tmp_path)
    assert "ZERO=<captured with an earlier reference>" in capsys.readouterr().out


def test_with_a_camera_both_commands_write_the_same(run_command: Callable[..., Any], tmp_path: Path) -> None:
    words = {"N": "16", "CAMERA": "raw10", "BAYER": "grbg"}
    assert run_command("wrap", "NAME=mine", f"OUT={tmp_path / 'wrap'}", *map("=".join, words.items())).status == 0
    assert of_fusesoc(words, tmp_path / "fusesoc") == files_of(tmp_path / "wrap")
    core = yaml.safe_load((tmp_path / "fusesoc" / "tables.core").read_text().removeprefix("CAPI=2:"))
    assert core["filesets"]["module"]["files"] == ["tactile_sensor_mine.sv"]


def test_a_bitstream_has_the_tables_of_wrap(
    run_command: Callable[..., Any], monkeypatch: pytest.MonkeyPatch, tmp_path: Path, picture: Path
) -> None:
    words = words_of("N=16 REFERENCE", picture)
    assert run_command("wrap", "NAME=mine", f"OUT={tmp_path / 'wrap'}", *map("=".join, words.items())).status == 0
    board = fpga.request_of({"TARGET": "ulx3s", **words})
    frames, twin = wrapped.design(board.design)
    monkeypatch.setattr(yosys, "design", lambda *_: {"modules": {board.top: {}}})
    monkeypatch.setattr(ecp5, "pack", lambda _: {})
    monkeypatch.setattr(ecp5, "pack_memories", lambda _: {})
    monkeypatch.setattr(ecp5, "copy_enables", lambda _: None)
    fpga.synthesize(board, twin, frames.camera, tmp_path / "fpga")
    module = (tmp_path / "wrap" / "tactile_depth_mine.sv").read_text()
    assert (tmp_path / "fpga" / "wrapper" / "tactile_depth_ulx3s.sv").read_text() == module.replace("_mine", "_ulx3s")
    tables = {name: (tmp_path / "wrap" / name).read_bytes() for name in table_files(tmp_path / "wrap")}
    assert {name: (tmp_path / "fpga" / name).read_bytes() for name in table_files(tmp_path / "fpga")} == tables
