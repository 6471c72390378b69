# SPDX-License-Identifier: Apache-2.0
"""Verdicts on fits: good ones of drawn presses, and bad ones with their likely cause."""

import base64
import io
import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import tactile_depth as td
from tactile_depth.base.errors import InputError, InputWarning
from tactile_depth.calibrate.fitting import fit_presses
from tactile_depth.calibrate.judgement import _background
from tactile_depth.calibrate.press_folder import HEAD
from tactile_depth.calibrate.press_pictures import gather
from tactile_depth.calibrate.presses import GridPresses, to_grid
from tactile_depth.cli.circle_page import circle_page
from tactile_depth.cli.main import main
from tactile_depth.sensor.verdict import Verdict
from tests.ball_presses import PITCH, pictures, places, real_folder, table_rows, write_folder, write_table


def verdict(presses: GridPresses) -> Verdict:
    return fit_presses(presses, ("quadratic",)).verdict


def changed(folder: Path, radii: bool = False, **change: Callable[[int, Any], Any]) -> GridPresses:
    """Return the presses with values changed by functions of the number of the press; without radii of balls."""
    gathered = gather(folder)
    listed = []
    for index, press in enumerate(gathered.presses):
        values = {name: value(index, getattr(press, name)) for name, value in change.items()}
        listed.append(replace(press, ball_radius_px=press.ball_radius_px if radii else None, **values))
    return to_grid(replace(gathered, presses=tuple(listed)), PITCH)


def test_presses_all_over_the_gel_are_good(presses: GridPresses) -> None:
    assert str(verdict(presses)) == "good"


def test_a_pitch_that_nothing_checks_is_said(folder: Path) -> None:
    checked = verdict(changed(folder))
    assert checked.grade == "good"
    assert [reason.split(":")[0] for reason in checked.reasons] == ["pitch and diameters not checked"]


def shifted(number: int, circle: tuple[float, float, float]) -> tuple[float, float, float]:
    x, y, radius = circle
    angle = 2.4 * number
    return (x + radius * np.cos(angle), y + radius * np.sin(angle), radius) if number % 2 else circle


BAD: dict[str, Any] = {
    "one diameter": ({"diameter_mm": lambda _, ball: 1.3 * ball if ball == 6 else ball}, "a wrong diameter: .* 7.8 mm"),
    "the other": ({"diameter_mm": lambda _, ball: 0.7 * ball if ball == 8 else ball}, "a wrong diameter: .* 5.6 mm"),
    "all diameters": ({"diameter_mm": lambda _, ball: 1.3 * ball}, "diameters too large, or a pitch too small: .* 0.7"),
    "circles": ({"circle": shifted}, "wrong circles: those of 1[0-9] of "),
}


@pytest.mark.parametrize("case", BAD)
def test_a_bad_fit_names_the_likely_cause(folder: Path, case: str) -> None:
    change, cause = BAD[case]
    found = verdict(changed(folder, **change))
    assert found.grade == "bad"
    (match,) = [reason for reason in found.reasons if "likely cause" in reason]
    assert re.search(cause, match), match


def test_radii_of_balls_that_give_two_pitches_are_told(folder: Path) -> None:
    one = changed(folder, radii=True, diameter_mm=lambda _, ball: 1.3 * ball if ball == 6 else ball)
    assert "the pitch is by balls of 7.8 mm 0.13 mm per pixel, 8 mm 0.1 mm" in str(verdict(one))


@pytest.mark.parametrize(("axis", "side"), [(0, "right"), (1, "bottom")])
def test_presses_on_one_side_alone_are_bad(presses: GridPresses, axis: int, side: str) -> None:
    rows, columns = presses.grid
    kept = [view for view in presses.views if (view.press.x / columns, view.press.y / rows)[axis] < 0.5]
    found = verdict(replace(presses, views=tuple(kept)))
    assert found.grade == "bad"
    assert f"none lies well to the {side}" in str(found)


def test_markers_on_the_gel_are_named(presses: GridPresses) -> None:
    rows, columns, _ = np.indices(presses.background.shape)
    dots = np.hypot(rows % 12 - 6, columns % 12 - 6) < 2
    dotted = np.where(dots, 0.3 * presses.background, presses.background).astype(np.uint8)
    found = verdict(replace(presses, background=dotted))
    assert found.grade == "bad"
    assert "markers: dark spots cover 6 % of the gel" in str(found)


def touched(presses: GridPresses, number: int) -> bool:
    """Return True if one press as background of all others is named."""
    views = presses.views[:number] + presses.views[number + 1 :]
    return _background(replace(presses, views=views, background_on_grid=presses.views[number].frame))[0] == "bad"


def test_a_background_in_which_something_touches_is_named(presses: GridPresses) -> None:
    assert all(touched(presses, number) for number in range(len(presses.views)))
    found = verdict(replace(presses, views=presses.views[1:], background_on_grid=presses.views[0].frame))
    assert found.grade == "bad"
    assert re.search(r"a touched background: it differs by \d\d % from the median of the presses", str(found))


def beside(presses: GridPresses, number: int, count: int = 8) -> GridPresses:
    """Return the presses nearest to one."""
    at = presses.views[number].press
    order = sorted(presses.views, key=lambda view: np.hypot(view.press.x - at.x, view.press.y - at.y))
    return replace(presses, views=tuple(order[:count]))


def test_presses_at_one_position_do_not_make_a_background_touched(presses: GridPresses) -> None:
    for number in range(len(presses.views)):
        assert _background(beside(presses, number)) == ("good", "")
        assert _background(beside(presses, number, 3)) == ("good", "")


def test_the_best_model_is_that_of_the_smallest_error_by_all_figures(presses: GridPresses) -> None:
    fit = fit_presses(presses, ("lut", "quadratic"))
    scores = fit.evaluation.scores
    low = tuple(
        replace(score, cap_height=0.64, height_rms_mm=0.5 * score.height_rms_mm) for score in scores["quadratic"]
    )
    evaluation = replace(fit.evaluation, scores={**scores, "lut": low})
    assert evaluation.best_model == "quadratic"
    assert evaluation.faults("lut")[0] == "caps read 0.64 of their height (good up to 0.06, usable up to 0.12)"
    assert evaluation.severity("lut") == pytest.approx(0.36 / 0.12)


def test_a_bad_calibration_is_refused_unless_asked_for_and_told_when_it_is_loaded(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, out = write_folder(tmp_path / "presses"), tmp_path / "mine.npz"
    rows = [{**row, "diameter_mm": 1.3 * row["diameter_mm"]} for row in table_rows()]
    write_table(folder, rows, ["frame", "diameter_mm", "centre_x_px", "centre_y_px", "contact_radius_px"])
    words = ["calibrate", str(folder), "--pitch-mm", str(PITCH), "--model", "quadratic", "--out", str(out)]
    assert main(words) == 2
    captured = capsys.readouterr()
    assert "verdict: bad\n- likely cause: diameters too large" in captured.out
    assert "mine.npz is not written, because the verdict of the fit is bad: mend the cause" in captured.err
    assert {path.name for path in tmp_path.glob("mine*")} == {f"mine-circles.{kind}" for kind in ("csv", "html", "png")}
    assert main([*words, "--keep-bad"]) == 0
    with pytest.warns(InputWarning, match=r"mine.npz: the verdict of its fit is bad; .*: calibrate again"):
        sensor = td.load(out)
    result = td.Pipeline(sensor, pictures()["background.png"])(pictures()["00.png"])
    doubt = "the verdict of the calibration is bad: heights may be wrong: calibrate again"
    assert (result.warnings, result.height_error) == ((doubt,), None)
    with pytest.warns(InputWarning, match="the verdict of the fit is bad; likely cause"):
        td.fit(folder, pitch_mm=PITCH, models="quadratic", quiet=True)


def test_circles_that_are_corrected_by_hand_are_given_back(tmp_path: Path) -> None:
    folder, out = write_folder(tmp_path / "presses"), tmp_path / "mine.npz"
    words = ["calibrate", str(folder), "--model", "quadratic", "--out", str(out)]
    assert main(words) == 0
    first, table = td.load(out), tmp_path / "mine-circles.csv"
    lines = table.read_text().splitlines()
    assert lines[0] == "frame,diameter_mm,centre_x_px,centre_y_px,contact_radius_px,ball_radius_px"
    name, diameter, x, y, radius, ball = places()[3]
    assert lines[4] == f"{name},{diameter:g},{x:.2f},{y:.2f},{radius:.2f},{ball:g}"
    (folder / "presses.csv").unlink()
    table.write_text("\n".join(lines[:4] + lines[5:]))
    assert main(words) == 2  # the table is not lost
    assert main([*words, "--circles", str(table)]) == 0
    assert td.load(out).height_errors != first.height_errors
    assert table.read_text().splitlines() == lines[:4] + lines[5:]
    with pytest.raises(InputError, match=r"none.csv: no such file: give a table with the columns of presses.csv"):
        gather(folder, table=tmp_path / "none.csv")


def test_the_page_holds_the_table_and_the_pictures(folder: Path, presses: GridPresses) -> None:
    pictures = gather(folder)
    data = re.search(r"const \[columns, rows, aspect, head, presses\] = (.*);\n", circle_page(pictures, presses))
    assert data is not None
    columns, rows, aspect, head, listed = json.loads(data[1])
    assert (columns, rows, aspect, head) == (160, 112, 1, list(HEAD))
    name, diameter, x, y, radius, ball = places()[3]
    assert listed[3]["cells"] == [name, f"{diameter:g}", f"{x:.2f}", f"{y:.2f}", f"{radius:.2f}", f"{ball:g}"]
    shown = np.asarray(Image.open(io.BytesIO(base64.b64decode(listed[3]["picture"]))))
    assert shown.shape == (112, 160, 3)
    assert abs(shown[:5].mean() - 128) < 2  # nothing changes there


def test_pictures_are_rotated_before_anything_else(folder: Path) -> None:
    upright = gather(folder)
    turned = [replace(press, image=np.rot90(upright.image(press), -1)) for press in upright.presses]
    again = gather(turned, np.rot90(upright.background, -1), rotate=90)
    np.testing.assert_array_equal(again.background, upright.background)
    for press, other in zip(upright.presses, again.presses, strict=True):
        np.testing.assert_array_equal(again.image(other), upright.image(press))
    with pytest.raises(InputError, match="rotate=45: accepted are 0, 90, 180, 270"):
        td.fit(folder, rotate=45)


def real(pitch_mm: float) -> GridPresses:
    """Return the real presses without radii of balls."""
    gathered = gather(real_folder())
    listed = tuple(replace(press, ball_radius_px=None) for press in gathered.presses)
    return to_grid(replace(gathered, presses=listed), pitch_mm)


def test_real_presses_are_good_and_any_half_of_them_is_usable() -> None:
    presses = real(0.0634)
    for first in range(2):
        assert verdict(replace(presses, views=presses.views[first::2])).grade != "bad"
    found = verdict(presses)
    assert found.grade != "bad"
    assert "pitch and diameters not checked" not in str(found)
    assert all(touched(presses, number) for number in range(0, 45, 4))
    assert all(_background(beside(presses, number)) == ("good", "") for number in range(0, 45, 4))


@pytest.mark.parametrize(("pitch_mm", "view"), [(1.2 * 0.0634, None), (0.0634 / 1.2, None), (0.0634, (1.0, 1.0))])
def test_a_wrong_pitch_is_named_where_a_sensor_of_the_same_kind_is_known(pitch_mm: float, view: Any) -> None:
    found = verdict(replace(real(pitch_mm), view=view))
    assert found.grade == "bad"
    expected = 0.0634 if view is None else 0.0888
    assert f"a wrong pitch or crop: {pitch_mm:.3g} mm per pixel, but {expected:.3g} by" in str(found)
