# SPDX-License-Identifier: Apache-2.0
"""The page of `make report`: what its first screen shows, what folds, and how long it says that it takes."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from commands.common import published
from commands.common.tabular import Table
from commands.study import budget, report, report_summary
from commands.study.report_page import Section, page
from commands.study.report_summary import BENCH, CONTACT, MARKS, SIZE, Run
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.latency import first_depth_latency, last_pixel_to_first_depth, last_pixel_to_last_depth

REPEATS = 2
SHAPES = len(BENCH)


def run_of(solver: str, **changes: Any) -> Run:
    """Return what `make sim` would leave, with depths that are 0.001 mm off."""
    config, frames = Configuration(columns=SIZE, solver=solver), REPEATS * SHAPES
    first, last = first_depth_latency(config), last_pixel_to_first_depth(config)
    contacts = [last + 100 * shape for shape in range(SHAPES)] * REPEATS
    document = {
        "first_depth_latency_cycles": [first] * frames,
        "last_pixel_to_first_depth_cycles": [last] * frames,
        "last_pixel_to_last_depth_cycles": [last_pixel_to_last_depth(config)] * frames,
        "last_depth_latency_cycles": [first + SIZE * SIZE - 1] * frames,
        "contact_latency_cycles": [first - last + cycles for cycles in contacts],
        CONTACT: contacts,
        "frame_interval_cycles": [None] + [SIZE * SIZE] * (frames - 1),
        "rms_percent_of_peak": [0.01] * frames,
        "frames": frames,
    }
    return Run(f"make sim SOLVER={solver}", document | changes, report_summary.exact_mm() + 0.001)


@pytest.fixture(scope="module")
def runs() -> dict[str, Run]:
    return {solver: run_of(solver) for solver in ("tridiagonal", "spectral")}


def test_the_first_table_stands_beside_the_published_figures(runs: dict[str, Run]) -> None:
    table = report_summary.summary_table(runs)
    assert list(table.head)[1:] == ["tridiagonal", "published design", "spectral"]
    ours, theirs = ({str(name): str(row[column]) for name, *row in table.rows} for column in (0, 1))
    config = Configuration(columns=SIZE, solver="tridiagonal")
    assert ours["first pixel to first depth"].startswith(f"{first_depth_latency(config):,} (")
    assert theirs["first pixel to first depth"].startswith(f"{published.FIRST_DEPTH_CYCLES[SIZE]:,} (")
    assert {*MARKS} < ours.keys()
    assert theirs["frames/s"] == "10,106"
    assert ours["error of the arithmetic; % of peak (worst)"] == "0.00100 mm; 0.0100 % (0.0100)"
    assert ours["multipliers 27 x 18 (DSP48E2)"].isdecimal()
    assert f"over {REPEATS * SHAPES} frames" in " ".join(ours)


def test_a_latency_that_varies_is_shown() -> None:
    last = last_pixel_to_first_depth(Configuration(columns=SIZE, solver="spectral"))
    steady = run_of("spectral")
    later = [last + 100 * shape + (7 if frame else 0) for frame in range(REPEATS) for shape in range(SHAPES)]
    assert [steady.spread(name) for name in (*MARKS.values(), CONTACT)] == [0, 0, 0, 0]
    assert run_of("spectral", **{CONTACT: later}).spread(CONTACT) == 7
    cells = report_summary.design_cells("spectral", run_of("spectral", **{CONTACT: later}))
    assert cells[len(MARKS) + 1] == "0; 0; 0; 7 cycles"


def test_only_the_first_section_is_open(runs: dict[str, Run], tmp_path: Path) -> None:
    table = Table(("a", "b"), [("1", "2")])
    text = page([report_summary.summary(runs, tmp_path), Section("more", "More", "With `code`.", "make", [table])], "x")
    first, fold = text.split("<details", 1)
    assert first.count("<table") == first.count("<img") == 1
    assert "<h2>In short</h2>" in first
    assert re.match(r" id='more'><summary><h2>More</h2></summary><p>With <code>code</code>\.</p>", fold)
    assert "<meta name='viewport' content='width=device-width" in first
    assert text.count("<table") == len(re.findall("<div class='scroll' tabindex='0'><table", text))
    assert not re.search("<img alt=''", text)


def test_results_of_a_figure_are_taken_from_the_repository(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(budget, "DEFAULT_OUT", tmp_path)
    document = report.recorded_document(budget, "budget")
    assert document is not None
    section = report.budget_section(document, tmp_path)
    assert "Recorded at commit" in section.text
    assert sum(len(table.rows) for table in section.tables) > 40
    monkeypatch.setattr(report.baselines, "DEFAULT_OUT", tmp_path)
    software = report.recorded_document(report.baselines, "baselines")
    assert software is not None
    assert report.baselines_section(software).tables
    assert report.recorded_document(report.reflex, "none of this name") is None


def test_it_says_how_long_it_takes(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for command in (report.budget, report.reflex, report.baselines, report.sweep):
        monkeypatch.setattr(command, "DEFAULT_OUT", tmp_path)
    whole, short = report.seconds(short=False), report.seconds(short=True)
    assert sum(short.values()) <= 180
    assert whole.keys() - short.keys() == {"sweep", "extremes", "budget", "reflex", "baselines"}
    (tmp_path / "reflex.json").write_text("{}")
    assert "reflex" not in report.seconds(short=False)
    report.announce(short)
    assert re.match(r"report takes about 2 minutes on two cores \(1,000 frames", capsys.readouterr().out)


def test_exact_depths_are_those_of_the_contacts() -> None:
    assert report_summary.exact_mm().shape == (SHAPES, SIZE, SIZE)
    assert np.all(report_summary.exact_mm().max(axis=(1, 2)) > 0)
