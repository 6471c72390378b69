# SPDX-License-Identifier: Apache-2.0
"""`make trade`: its rows are what the RTL does and are measured once; which are beaten, and the knee."""

import csv
from typing import Any

import pytest

from commands.common import run_request
from commands.study import trade, trade_front
from commands.study.rows import Row
from tests import ball_presses

PRESSES = 20  # drawn, so that each fold leaves enough in the middle


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> trade.Study:
    folder = tmp_path_factory.mktemp("trade")
    source = ball_presses.write_folder(folder / "drawn", PRESSES)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(trade, "FORMATS", ("rgb888", "raw8"))
        return trade.prepare(folder / "out", source, None)


def choices(*words: int, **others: str) -> trade.Choices:
    return trade._choices((24, 32), words or trade.WIDE, **others)  # type: ignore[arg-type]


def test_the_plan_is_made_of_variables_of_make_sim() -> None:
    plan = trade.plan()
    assert len(plan) >= 500
    assert len({tuple(sorted(row.items())) for row in plan}) == len(plan)
    assert {row["CAMERA"] for row in plan} == set(trade.FORMATS)
    for row in plan:
        run_request.check_grid(run_request.of_values(row | {"FRAMES": "ball"}, run_request.WITH_CAMERA, "sensor"))


def test_wider_words_err_less_and_cost_more(study: trade.Study) -> None:
    wide, narrow = (trade.measure(study, choices(*words)) for words in (trade.WIDE, (12, 10, 16)))
    assert wide["problem"] == narrow["problem"] == ""
    assert float(wide["height_um"]) < float(narrow["height_um"])
    assert int(wide["presses"]) == len(study.middle) > 4
    for name in ("multipliers_18", "luts", "memory_bits", "power_mw"):
        assert float(wide[name]) > float(narrow[name])
    assert int(wide["first_depth_cycles"]) < float(wide["contact_cycles"]) <= int(wide["map_cycles"]) + 1
    assert "FRAMES=" in wide["command"]


def test_a_square_shows_the_middle_alone(study: trade.Study) -> None:
    row = trade.measure(study, trade._choices((32, 32), trade.WIDE, SOLVER="spectral"))
    assert row["sides_height_um"] == ""
    assert row["presses"] == str(len(study.middle))


def test_what_cannot_be_built_is_a_row(study: trade.Study) -> None:
    row = trade.measure(study, trade._choices((96, 128), trade.WIDE, CAMERA="raw8"))
    assert "2 are needed" in row["problem"]
    assert row["height_um"] == ""


def test_rows_are_measured_once(study: trade.Study, monkeypatch: pytest.MonkeyPatch) -> None:
    wanted = [choices(), choices(12, 10, 16)]
    rows = trade.study_rows(study, wanted[:1])
    monkeypatch.setattr(trade, "measure", None)  # of the parent process: rows that are there need none
    assert trade.study_rows(study, wanted[:1]) == rows
    with (study.folder / "trade.csv").open(newline="") as file:
        assert list(csv.DictReader(file)) == rows


def test_the_folds_are_kept(study: trade.Study, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trade, "FORMATS", ("rgb888", "raw8"))
    monkeypatch.setattr(trade, "_calibrate", None)
    assert trade.prepare(study.folder, study.source, None) == study


@pytest.mark.regress
def test_a_row_is_what_the_rtl_does(study: trade.Study) -> None:
    rows = [trade.measure(study, choices(15, 12, 16))]
    assert trade.in_rtl(study, rows, 1, seed=1, simulator="icarus") == 0


def row(**changed: Any) -> Row:
    """Return a row with all axes 100 but those given."""
    same = dict.fromkeys((*trade_front.ERRORS, *trade_front.COSTS), "100")
    other = {name: str(value) for name, value in changed.items()}
    return {"problem": "", "boundary": "neumann", "pixel_format": "rgb888", **same, **other}


def test_a_row_is_beaten_by_one_that_is_no_worse_in_anything() -> None:
    rows = [row(), row(luts=90), row(luts=80, height_um=100.01), row(luts=80, height_um=101), row(sides_height_um="")]
    assert trade_front.beaten_by(rows) == [1, 2, None, 2, 0]


def test_the_knee_has_the_least_silicon_of_those_that_are_near() -> None:
    near = {"untouched_um": 50, "multipliers_18": 80}
    rows = [row(height_um=50, untouched_um=50), row(height_um=56, **near), row(height_um=50, multipliers_18=10)]
    assert trade_front.knee(rows) == rows[1]
    rows.append(
        row(height_um=50, untouched_um=50, multipliers_18=1, sides_height_um="")
    )  # does not show the whole picture
    assert trade_front.knee(rows) == rows[1]
