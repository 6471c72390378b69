# SPDX-License-Identifier: Apache-2.0
"""`make trade`: its rows are what the RTL does and are measured once; which are beaten, and the knee."""

from pathlib import Path
from typing import Any

import pytest

from commands.common import run_request
from commands.study import study, trade, trade_front
from commands.study.trade_front import Point, Row
from tactile_depth.base.errors import InputError
from tests import ball_presses

PRESSES = 20  # drawn, so that each fold leaves enough in the middle


@pytest.fixture(scope="module")
def presses(tmp_path_factory: pytest.TempPathFactory) -> trade.Prepared:
    folder = tmp_path_factory.mktemp("trade")
    source = ball_presses.write_folder(folder / "drawn", PRESSES)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(trade, "FORMATS", ("rgb888", "raw8"))
        return trade.prepare(folder / "out", source, None)


def point(words: tuple[int, int, int] = trade.WIDE) -> Point:
    return trade.point((24, 32), words)


def test_the_plan_is_made_of_variables_of_make_sim() -> None:
    plan = trade.plan()
    assert len(plan) >= 500
    assert len(set(plan)) == len(plan)
    assert {each.pixel_format for each in plan} == set(trade.FORMATS)
    for each in plan:
        values = trade.of_sim(each) | {"FRAMES": "ball"}
        request = run_request.of_values(values, run_request.WITH_CAMERA, "sensor")
        run_request.check_grid(request)
        shared = vars(each).keys() & vars(request).keys() - {"light_gains"}
        assert {name: getattr(request, name) for name in shared} == {name: getattr(each, name) for name in shared}


def test_the_plan_leaves_out_what_was_never_on_the_front() -> None:
    plan = trade.plan()
    assert not {each.data_width for each in plan} & {21, 22, 23}
    assert {each.lanes for each in plan} == {1, 4, 8, 16, 32}


def test_wider_words_err_less_and_cost_more(presses: trade.Prepared) -> None:
    measured = trade.study_of(presses).measured
    wide, narrow = measured(point()), measured(point((12, 10, 16)))
    assert wide.problem == narrow.problem == ""
    assert wide.height_um < narrow.height_um
    assert wide.presses == len(presses.middle) > 4
    for name in ("multipliers_18", "luts", "memory_bits", "power_mw"):
        assert getattr(wide, name) > getattr(narrow, name)
    assert wide.first_depth_cycles < wide.contact_cycles <= wide.map_cycles + 1
    assert "FRAMES=" in wide.command


def test_a_square_shows_the_middle_alone(presses: trade.Prepared) -> None:
    row = trade.study_of(presses).measured(trade.point((32, 32), trade.WIDE, solver="spectral"))
    assert row.sides_height_um is None
    assert row.presses == len(presses.middle)


def test_what_cannot_be_built_is_a_row(presses: trade.Prepared) -> None:
    row = trade.study_of(presses).measured(trade.point((96, 128), trade.WIDE, pixel_format="raw8"))
    assert "2 are needed" in row.problem
    assert row.height_um is None


def test_rows_are_measured_once(presses: trade.Prepared, monkeypatch: pytest.MonkeyPatch) -> None:
    wanted = [point()]
    rows = trade.study_of(presses).complete(wanted, presses.folder)
    monkeypatch.setattr(study, "on_all_cores", lambda measure, points: (pytest.fail(str(each)) for each in points))
    assert trade.study_of(presses).complete(wanted, presses.folder) == rows
    assert study.read(presses.folder / "trade.csv", Row) == rows


def test_the_folds_are_kept(presses: trade.Prepared, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trade, "FORMATS", ("rgb888", "raw8"))
    monkeypatch.setattr(trade, "_calibrate", None)
    assert trade.prepare(presses.folder, presses.source, None) == presses


def test_folders_of_others_are_not_removed(presses: trade.Prepared, tmp_path: Path) -> None:
    mine = tmp_path / "presses-0" / "mine.png"
    mine.parent.mkdir()
    mine.touch()
    with pytest.raises(InputError, match="presses-0 in it is of no earlier run"):
        trade.prepare(tmp_path, presses.source, None)
    assert mine.exists()


@pytest.mark.regress
def test_a_row_is_what_the_rtl_does(presses: trade.Prepared) -> None:
    rows = [trade.study_of(presses).measured(point((15, 12, 16)))]
    assert trade.in_rtl(presses, rows, 1, seed=1, simulator="icarus") == 0


def row(**changed: Any) -> Row:
    """Return a row with all axes 100 but those given."""
    same: dict[str, Any] = dict.fromkeys((*trade_front.ERRORS, *trade_front.COSTS), 100)
    others: dict[str, Any] = {
        "problem": "",
        "presses": 9,
        "cap_percent": 1.0,
        "saturations": 0,
        "command": "",
        "models": "",
    }
    return Row(**(vars(trade_front.DEFAULT) | others | same | changed))


def test_a_row_is_beaten_by_one_that_is_no_worse_in_anything() -> None:
    rows = [row(), row(luts=90), row(luts=80, height_um=100.01), row(luts=80, height_um=101), row(sides_height_um=None)]
    assert trade_front.beaten_by(rows) == [1, 2, None, 2, 0]


def test_the_knee_has_the_least_silicon_of_those_that_are_near() -> None:
    near = {"untouched_um": 50, "multipliers_18": 80}
    rows = [row(height_um=50, untouched_um=50), row(height_um=56, **near), row(height_um=50, multipliers_18=10)]
    assert trade_front.knee(rows) == rows[1]
    rows.append(
        row(height_um=50, untouched_um=50, multipliers_18=1, sides_height_um=None)
    )  # does not show the whole picture
    assert trade_front.knee(rows) == rows[1]
