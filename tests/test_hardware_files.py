# SPDX-License-Identifier: Apache-2.0
"""Pipeline.hardware: its files are what the pipeline computes with, and replace those of an earlier pipeline alone."""

import json
from pathlib import Path
from typing import Any

import pytest

import tactile_depth as td
from tactile_depth.base.files import RECORD
from tactile_depth.chip.c_header import FILE, c_header
from tactile_depth.chip.gradient.frame_marks import slope_limit
from tactile_depth.chip.rom_files import write_words
from tactile_depth.chip.tactile_depth import hdl_parameters, top_parameters
from tactile_depth.chip.tactile_depth import write_roms as write_tables


def test_hardware_writes_what_the_pipeline_computes_with(tmp_path: Path, small: Any) -> None:
    index = small.hardware(tmp_path / "hw")
    described = json.loads(index.read_text())
    assert described["depth_lsb_mm"] == small.depth_lsb_mm
    (tmp_path / "again").mkdir()
    crc = write_tables(tmp_path / "again", small.sensor, small.config, small._zero, small._gains)
    assert described["fields"] == top_parameters(small.config, small.pixel_pitch_mm, tables_crc=crc)
    assert described["parameters"] == hdl_parameters(small.config, small.pixel_pitch_mm, tables_crc=crc)
    tables = {path.name: path.read_text() for path in (tmp_path / "again").iterdir()}
    assert described["tables"] == sorted(tables)
    assert described["registers"].pop("SLOPE_LIMIT") == slope_limit(small.sensor, small.config)
    tables[described["c_header"]] = c_header(
        small.sensor, small.config, small._zero, small._gains, described["registers"]
    )
    written = {path.name: path.read_text() for path in (tmp_path / "hw").iterdir()}
    assert written.keys() == {*tables, index.name, RECORD}
    assert written.items() > tables.items()


def test_hardware_removes_the_tables_of_an_earlier_pipeline_and_nothing_else(
    tmp_path: Path, small: Any, ball: Any
) -> None:
    small.hardware(tmp_path)
    (tmp_path / "notes.txt").write_text("mine")
    write_words(tmp_path / "other.hex", [1], 4)
    td.Pipeline(ball.sensor, ball.reference, grid=(32, 32), solver="spectral", model="lut").hardware(tmp_path)
    tables = json.loads((tmp_path / "parameters.json").read_text())["tables"]
    left = sorted(path.name for path in tmp_path.iterdir())
    assert left == sorted([*tables, RECORD, "notes.txt", "other.hex", "parameters.json", FILE])
    assert "down.hex" not in tables


def test_a_folder_with_the_name_of_a_table_is_not_replaced(tmp_path: Path, small: Any) -> None:
    mine = tmp_path / "down.hex" / "mine.txt"
    mine.parent.mkdir()
    mine.write_text("mine")
    with pytest.raises(td.InputError, match=r"cannot be written \(down\.hex in it is a folder\): remove it or give"):
        small.hardware(tmp_path)
    assert sorted(tmp_path.rglob("*")) == [mine.parent, mine]


def test_a_folder_that_cannot_be_written_is_named(tmp_path: Path, small: Any) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(td.InputError, match=r"file/hw cannot be written"):
        small.hardware(tmp_path / "file" / "hw")
