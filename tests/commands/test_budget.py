# SPDX-License-Identifier: Apache-2.0
"""make budget: its parts add up, one that is switched off vanishes, and the whole is the error that others measure."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tactile_depth as td
from commands.study import budget
from commands.study.budget import BudgetRun, DrawnSensor
from commands.study.budget_steps import BACK, FRONT, MEASURES, Exact, framed
from commands.study.drawn_sensor import PLACES
from commands.study.presses import measured
from tactile_depth.base.errors import InputError
from tactile_depth.calibrate.press_pictures import PressPictures
from tactile_depth.calibrate.presses import GridPresses, to_grid
from tactile_depth.chip.camera_configuration import CameraChoice
from tactile_depth.chip.configuration import COEFFICIENT, STORED
from tactile_depth.chip.poisson.divergence import divergence
from tactile_depth.depth import reference

STILL = DrawnSensor(camera=(120, 160), drift=0, white=0)
SMALL = BudgetRun(drawn=replace(STILL, drift=0.05, white=0.02), presses=10, bodies=2)


@pytest.fixture(scope="module")
def pictures() -> PressPictures:
    return STILL.presses(SMALL.presses, np.random.default_rng(1))


@pytest.fixture(scope="module")
def presses(pictures: PressPictures) -> GridPresses:
    return to_grid(pictures, STILL.pitch_mm, choice=SMALL.choice)


def whole(found: dict[str, np.ndarray]) -> dict[str, float]:
    """Return the RMS of the whole error in mm by measure, of the products of one picture."""
    return {measure: float(np.sqrt(found[measure].sum())) for measure in MEASURES}


def parts(request: BudgetRun, measure: str = "contact") -> dict[str, float]:
    """Return the RMS of each part in um, of all drawn contacts."""
    found = np.array([each[measure] for _, each in budget.drawn_contacts(request)])
    rms = budget.numbers_of(found.mean(axis=0))["rms_um"]
    return dict(zip((*FRONT, *BACK), rms.tolist(), strict=True))


def test_true_steps_of_the_height_solve_to_the_height() -> None:
    height = np.random.default_rng(1).normal(size=(12, 16))
    slopes = np.stack((np.diff(height, axis=1, append=0), np.diff(height, axis=0, append=0)), axis=-1)
    assert np.abs(framed(slopes, height) - height).max() < 1e-12
    free = reference.solve(divergence(slopes, True), True)
    assert np.abs(free - (height - height.mean())).max() < 1e-12


def test_double_precision_is_that_of_the_package(presses: GridPresses) -> None:
    sensor, rest = budget.fitted(presses).sensor, presses.background_on_grid
    exact, chip = (td.Pipeline(sensor, rest, grid=presses.grid, arithmetic=which) for which in ("float", "chip"))
    frame = presses.views[0].frame
    ours = Exact(chip, rest)
    depth = ours.depth(ours.slopes(frame)) * chip.pixel_pitch_mm
    assert np.abs(depth - exact(frame).depth_mm).max() < 1e-4  # light gains in words of 16 bits


def test_the_whole_error_of_a_press_is_that_of_make_presses(pictures: PressPictures, presses: GridPresses) -> None:
    request = replace(SMALL, drawn=replace(STILL, noise=0), pitch_mm=STILL.pitch_mm)
    fit = budget.fitted(presses)
    views = [view for view in presses.views if view.press.name in fit.without]
    for view, (place, found) in zip(views, budget.real_presses(request, pictures), strict=True):
        sensor = replace(fit.without[view.press.name], camera=fit.sensor.camera)
        ours = measured(request.pipeline(sensor, presses.background_on_grid)(view.frame), view.press)
        assert place == PLACES[not view.press.is_central]
        assert whole(found)["contact"] == pytest.approx(ours.height_rms)
        assert whole(found)["untouched"] == pytest.approx(ours.rest_rms)
        rms = dict(zip((*FRONT, budget.BESIDE, *BACK), np.sqrt(found["contact"].diagonal()), strict=True))
        assert rms["light drift"] == 0


def test_a_part_that_is_switched_off_vanishes() -> None:
    given, noisy = (parts(replace(SMALL, drawn=replace(STILL, noise=noise))) for noise in (0, 4))
    plain = parts(replace(SMALL, choice=CameraChoice("rgb888"), numbers={STORED: 14, COEFFICIENT: 12}))
    assert given["camera noise and 8 bits"] < 0.5 * noisy["camera noise and 8 bits"]  # rounding is left
    assert plain["pixel format"] == 0 < given["pixel format"]
    assert given["quantisation"] < 0.1 * plain["quantisation"]
    fixed = parts(replace(SMALL, neumann=False))
    assert fixed["boundary"] > 5 * given["boundary"]


def test_the_tables_the_picture_and_what_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("TACTILE_DATA", str(tmp_path))
    budget.run(replace(SMALL, out=tmp_path / "out"))
    out = capsys.readouterr().out
    assert "no real presses were measured: no presses: " in out
    document = json.loads((tmp_path / "out" / "budget.json").read_text())
    assert (tmp_path / "out" / "budget.png").exists()
    (source,) = document["sources"]
    assert list(source["places"]) == list(PLACES)
    for place in source["places"].values():
        for measure in MEASURES:
            found = place[measure]
            assert sum(value for value, _, _ in found["share"]) == pytest.approx(1)
            for value, low, high in (*found["rms_um"], found["whole_um"]):
                assert low <= value * (1 + 1e-9)
                assert value <= high * (1 + 1e-9)
    titles = [table.title for table in budget.tables(json.loads(json.dumps(document)))]
    assert titles == ["In short", *(f"drawn contacts, {name}" for name in MEASURES.values())]
    assert all(title in out for title in titles)


@pytest.mark.parametrize(
    ("argument", "named"),
    [
        ("CAMERA=raw9", "CAMERA=raw9"),
        ("BOUNDARY=none", "BOUNDARY=none"),
        ("DATA_WIDTH=99", "DATA_WIDTH=99"),
        ("N=64", "N=64"),
    ],
)
def test_bad_input_is_named(argument: Any, named: Any) -> None:
    with pytest.raises(InputError) as caught:
        budget.variables.read(BudgetRun, [argument])
    assert named in caught.value.text(budget.variables.named)
    assert "\n" not in str(caught.value)
