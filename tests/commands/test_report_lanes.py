# SPDX-License-Identifier: Apache-2.0
"""The section of `make report` on lanes: a line for each number of lanes, with what the hardware flows left for it."""

import json
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest

from commands.common import run_request
from commands.cost.cost import cost
from commands.study import report_lanes, report_page, sweep
from commands.study.sweep import Row
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.latency import last_pixel_to_first_depth, last_pixel_to_last_depth


def row(columns: int, lanes: int) -> Row:
    """Return what the section reads of a row of the sweep."""
    config = Configuration(columns=columns, solver="tridiagonal", lanes=lanes)
    cells: dict[str, Any] = vars(sweep.square(columns, solver="tridiagonal", lanes=lanes)) | {
        "problem": "",
        "last_pixel_to_first_depth_cycles": last_pixel_to_first_depth(config),
        "last_pixel_to_last_depth_cycles": last_pixel_to_last_depth(config),
        "multipliers": cost(config).tiles,
        "memory_bits": cost(config).memory_bits,
    }
    every: dict[str, Any] = dict.fromkeys(column.name for column in fields(Row))
    return Row(**(every | cells))


def test_every_number_of_lanes_has_a_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [row(columns, lanes) for columns in sweep.LANE_GRIDS for lanes in sweep.lane_counts(columns)]
    described = run_request.described(Configuration(columns=128, solver="tridiagonal", lanes=8))
    totals = {"DSP48E2": 151, "LUT": 45678, "FF": 23456, "BRAM36": 77.5, "UltraRAM": 0}
    other = described | {"lanes": 4}
    for flow, name, content in (
        ("synth", "resources.json", {"designs": [{"configuration": described, "totals": totals}]}),
        ("fpga", "fpga.json", other | {"fmax_mhz": 98.76}),
    ):
        folder = tmp_path / flow / "one"
        folder.mkdir(parents=True)
        (folder / name).write_text(json.dumps(content))
    monkeypatch.setattr(report_page, "BUILD", tmp_path)
    html = report_lanes.lanes_section(list(reversed(rows)), tmp_path).html()
    lines = html.split("<tr>")[2:]
    assert len(lines) == len(rows)
    for expected, line in zip(rows, lines, strict=True):
        assert f"<td>{expected.columns} x {expected.columns}</td><td>{expected.lanes}</td>" in line
        assert f"<td>{expected.last_pixel_to_last_depth_cycles:,}</td>" in line
        assert ("45,678" in line) == ((expected.columns, expected.lanes) == (128, 8))
        assert ("98.8" in line) == ((expected.columns, expected.lanes) == (128, 4))
    assert (tmp_path / "lanes.png").exists()
