# SPDX-License-Identifier: Apache-2.0
"""fit and evaluate on presses drawn with known slopes and colours."""

import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import tactile_depth as td
from tactile_depth.base.errors import InputError, InputWarning
from tactile_depth.calibrate.evaluation import scores_of
from tactile_depth.calibrate.fitting import (
    FITTED_SHARE,
    fit_presses,
)
from tactile_depth.chip.limits import MODELS
from tactile_depth.depth.reference import pixel_terms
from tactile_depth.sensor.scenes import LIGHTS
from tests.ball_presses import (
    CAMERA,
    PITCH,
    SENSITIVITY,
    pictures,
    places,
    table_rows,
    weakness,
    write_table,
)
from tests.picture_edits import few_colours


@pytest.fixture(scope="module")
def fit(presses: Any) -> Any:
    """Fit of every model to the presses."""
    return fit_presses(presses, name="presses", exposure_us=8000)


@pytest.fixture(scope="module")
def sensor(fit: Any) -> Any:
    return fit.sensor


@pytest.fixture(scope="module")
def quadratic(presses: Any) -> Any:
    return fit_presses(presses, ("quadratic",))


@pytest.fixture(scope="module")
def found() -> Any:
    """Sensor fitted to the presses in memory, whose circles `fit` finds: they are the same for each model."""
    return td.fit(*in_memory(np.array, False), pitch_mm=PITCH, models="cubic", quiet=True)


# The fit of drawn presses, whose slopes are known.


def test_the_polynomials_of_the_lights_are_recovered(presses: Any, quadratic: Any) -> None:
    coefficients = quadratic.sensor.polynomials("quadratic")
    rows, columns = presses.grid
    terms = pixel_terms(rows, columns, presses.grid_pitch_mm)
    by_colour = np.einsum("ant,rct->rcan", coefficients, terms)
    # Three colours span two slopes, so coefficients are known only along the directions of the lights.
    response = by_colour @ (SENSITIVITY * LIGHTS)
    want = weakness(terms[..., 1], terms[..., 2])[..., None, None] * np.eye(2)
    middle = np.hypot(terms[..., 1], terms[..., 2]) < 5
    assert np.abs(response - want)[middle].max() < 0.06  # measured: 0.055


@pytest.mark.parametrize(
    ("model", "rms_mm", "bias", "spread"),
    [("quadratic", 0.012, 0.03, 0.03), ("cubic", 0.012, 0.03, 0.03), ("lut", 0.03, 0.05, 0.08)],
)
def test_presses_left_out_come_out_as_the_balls_are(
    fit: Any, model: Any, rms_mm: float, bias: Any, spread: float
) -> None:
    evaluation = fit.evaluation
    error = evaluation.height_error(model)
    assert error.presses == sum(evaluation.central) >= 4
    assert len(evaluation.presses) > error.presses
    assert evaluation.values(model, "height_rms_mm").mean() < rms_mm
    assert abs(error.mean - 1) < bias
    assert error.spread < spread


def test_each_press_is_measured_by_a_fit_to_the_others(presses: Any, quadratic: Any) -> None:
    evaluation = quadratic.evaluation
    measured = [view for view in presses.views if view.is_whole]
    assert evaluation.presses == tuple(view.press.name for view in measured)
    others = tuple(view for view in presses.views if view is not measured[-1])
    coefficients: Any = fit_presses(replace(presses, views=others), ("quadratic",)).sensor.coefficients
    alone: Any = quadratic.without[measured[-1].press.name]
    np.testing.assert_allclose(alone.coefficients, coefficients, rtol=1e-9)
    steepest = max(view.press.largest_slope for view in others)
    sensor = td.Sensor("others", None, PITCH, coefficients, steepest, "quadratic")
    assert scores_of(sensor, presses, measured[-1:], "quadratic")[0] == evaluation.scores["quadratic"][-1]


def test_balls_that_contradict_each_other_are_said(presses: Any, quadratic: Any) -> None:
    """Give one of the balls a diameter that is 8 % too small: its presses read too high."""
    wrong = tuple(
        replace(view, press=replace(view.press, ball_radius=0.92 * view.press.ball_radius))
        if view.diameter_mm == 6
        else view
        for view in presses.views
    )
    pattern = r"quadratic, caps by ball: 6 mm (\S+), 8 mm (\S+)(.*)"
    contradicting = fit_presses(replace(presses, views=wrong), ("quadratic",))
    right, doubtful = (re.search(pattern, each.evaluation.summary) for each in (quadratic, contradicting))
    assert right is not None
    assert doubtful is not None
    assert not right[3]
    assert float(doubtful[1]) < 0.98 * float(doubtful[2].rstrip(";"))
    assert "the scale is not known better than these" in doubtful[3]


def test_the_table_gives_a_bin_the_mean_slope_of_its_pixels(fit: Any, presses: Any) -> None:
    views, gradient = presses.views, fit.sensor.gradient
    assert gradient.shape == (32, 32, 32, 2)
    truth, codes = (
        np.concatenate([value(view)[view.press.distance < FITTED_SHARE] for view in views])  # type: ignore[no-untyped-call]
        for value in (lambda view: view.press.slopes, lambda view: view.codes >> 3)
    )
    index = np.ravel_multi_index(tuple(codes.T), (32, 32, 32))
    steep = np.hypot(*truth.T) > 0.35  # colours that no frame without contact has
    busiest = np.bincount(index[steep]).argmax()
    at = np.unravel_index(busiest, (32, 32, 32))
    np.testing.assert_allclose(gradient[at], truth[index == busiest].mean(axis=0), atol=0.03)


def test_a_gel_at_rest_reads_flat_through_the_table(fit: Any) -> None:
    assert np.abs(fit.sensor.gradient[15:17, 15:17, 15:17]).max() < 0.06  # a step of the codes is 0.09 of slope


# The fitted sensor.


def test_a_sensor_knows_what_it_was_fitted_to(sensor: Any, presses: Any) -> None:
    steepest = max(view.press.largest_slope for view in presses.views)
    assert (sensor.camera.rows, sensor.camera.columns, sensor.camera.exposure_us) == (*CAMERA, 8000)
    assert sensor.flat_field
    assert sensor.model == "cubic"
    assert sensor.pixel_pitch_mm == PITCH
    assert sensor.bits_per_channel == 5
    assert sensor.fitted_slope == dict.fromkeys(MODELS, steepest)
    assert sensor.largest_slope == steepest
    assert sensor.height_errors["lut"].presses == sum(view.press.is_central for view in presses.views)
    assert sensor.name == "presses"


def test_a_sensor_is_the_same_from_a_file(sensor: Any, tmp_path: Path) -> None:
    path = tmp_path / "mine.npz"
    sensor.save(path)
    again = td.load(path)
    for field in ("gradient", "coefficients", "cubic", "corrections", "lighting"):
        np.testing.assert_array_equal(getattr(again, field), getattr(sensor, field))
    for field in ("camera", "fitted_slope", "height_errors", "model", "largest_slope", "flat_field", "verdict"):
        assert getattr(again, field) == getattr(sensor, field), field


def test_a_picture_becomes_the_height_of_its_ball(sensor: Any) -> None:
    name, diameter, x, y, contact, ball = places()[8]
    pipeline = td.Pipeline(sensor, pictures()["background.png"])
    result = pipeline(pictures()[name])
    scale = result.pixel_pitch_mm / PITCH
    row, column = round((y + 0.5) / scale), round((x + 0.5) / scale)
    edge = (column + round(contact / scale), column - round(contact / scale))
    height = result.depth_mm[row, column] - np.mean([result.depth_mm[row, at] for at in edge])
    assert height == pytest.approx(diameter / 2 - math.sqrt(ball**2 - contact**2) * PITCH, rel=0.1)


def test_presses_in_memory_give_the_same_sensor(sensor: Any) -> None:
    balls = [
        td.BallPress(pictures()[name], diameter, (x, y, contact), name) for name, diameter, x, y, contact, _ in places()
    ]
    background = pictures()["background.png"]
    again = td.fit(balls, background, pitch_mm=PITCH, models="quadratic", name="mine", quiet=True)
    np.testing.assert_array_equal(again.coefficients, sensor.coefficients)
    assert again.gradient is None
    assert again.name == "mine"


def test_a_background_may_be_a_pil_image_and_the_name_is_that_of_the_folder(sensor: Any, folder: Path) -> None:
    image = Image.fromarray(pictures()["background.png"])
    fitted = td.fit(folder, image, models="quadratic", exposure_us=8000, quiet=True)
    assert (fitted.name, fitted.camera) == (sensor.name, sensor.camera)
    np.testing.assert_array_equal(fitted.coefficients, sensor.coefficients)


def test_what_is_left_out_is_warned_of(folder: Path) -> None:
    balls = [td.BallPress(folder / row["frame"], row["diameter_mm"]) for row in table_rows()]
    background = pictures()["background.png"]
    balls[3] = td.BallPress(background, 8.0, name="empty")
    with pytest.warns(InputWarning, match="empty: no circle to be seen: left out"):
        sensor = td.fit(balls, background, pitch_mm=PITCH, models="quadratic")
    assert sensor.height_errors["quadratic"].mean == pytest.approx(1, abs=0.06)


def in_memory(change: Any, circles: bool, columns: float = 1) -> tuple[list[td.BallPress], np.ndarray]:
    """Return the presses and the background with changed pictures, whose pixels are 1 / `columns` times as wide."""
    return [
        td.BallPress(
            change(pictures()[name]), diameter, ((x + 0.5) * columns - 0.5, y, contact) if circles else None, name
        )
        for name, diameter, x, y, contact, _ in places()
    ], change(pictures()["background.png"])


def narrowed(picture: np.ndarray) -> np.ndarray:
    """Return a picture with pixels that are 1.25 times as wide as high."""
    size = (CAMERA[1] * 4 // 5, CAMERA[0])
    return np.asarray(Image.fromarray(picture).resize(size, Image.Resampling.BOX))


@pytest.mark.parametrize("circles", [True, False])
def test_pixels_that_are_not_square_give_the_same_millimetres(
    sensor: Any, found: Any, tmp_path: Path, circles: bool
) -> None:
    balls, background = in_memory(narrowed, circles, 0.8)
    chosen: Any
    chosen, square = ({}, sensor) if circles else ({"models": "cubic"}, found)
    wide: td.Sensor = td.fit(balls, background, pitch_mm=(PITCH, 1.25 * PITCH), quiet=True, **chosen)
    assert wide.models == square.models
    assert (wide.pixel_pitch_mm, wide.pixel_aspect) == (PITCH, 1.25)
    for model in wide.models:
        error, other = wide.height_errors[model], square.height_errors[model]
        assert error.mean == pytest.approx(other.mean, abs=0.02)
        assert error.spread < max(1.3 * other.spread, 0.01)
    wide.save(tmp_path / "wide.npz")
    again = td.load(tmp_path / "wide.npz")
    assert again.pixel_aspect == 1.25
    assert td.evaluate(again, balls, background).scores.keys() == wide.height_errors.keys()
    seen = (
        td.Pipeline(again, background)(balls[8].image),
        td.Pipeline(square, pictures()["background.png"])(pictures()[places()[8][0]]),
    )
    one, two = (result.contact for result in seen)
    assert seen[0].height_mm.max() == pytest.approx(seen[1].height_mm.max(), rel=0.02)
    assert one.area_mm2 == pytest.approx(two.area_mm2, rel=0.05)
    assert one.volume_mm3 == pytest.approx(two.volume_mm3, rel=0.05)
    assert one.centroid_mm == pytest.approx(two.centroid_mm, abs=0.1)
    assert np.abs(seen[0].slopes).max() == pytest.approx(np.abs(seen[1].slopes).max(), rel=0.1)


def test_contacts_that_are_no_circles_are_warned_of() -> None:
    balls, background = in_memory(narrowed, False)
    with pytest.warns(
        InputWarning, match=r"contacts are \d\d % narrower than high, .* give pitch_mm=\(height, width\)"
    ):
        td.fit(balls, background, pitch_mm=PITCH, models="quadratic", quiet=True)


def test_grey_pictures_are_refused() -> None:
    def grey(picture: np.ndarray) -> np.ndarray:
        return picture[..., [1, 1, 1]]

    def tinted(picture: np.ndarray) -> np.ndarray:
        return (grey(picture) * (0.8, 1, 0.9)).astype(np.uint8)

    for change in (grey, tinted):
        with pytest.raises(InputError, match="the colours of all presses change alike, as in grey pictures"):
            td.fit(*in_memory(change, True), pitch_mm=PITCH, quiet=True)


def test_pictures_reduced_to_a_palette_are_refused() -> None:
    balls, background = in_memory(few_colours, True)
    with pytest.raises(InputError, match=r"background: it has 2.. colours in all, as if reduced to a palette"):
        td.fit(balls, background, pitch_mm=PITCH, quiet=True)
    with pytest.raises(InputError, match=r"it has 2.. colours in all, .*: left out"):
        td.fit(balls, pictures()["background.png"], pitch_mm=PITCH, quiet=True)


def test_markers_on_the_gel_hide_no_circle(found: Any) -> None:
    """Draw dark dots that stay where they are: their light is divided by that of the background."""
    rows, columns = np.indices(CAMERA)
    dots = np.hypot(rows % 24 - 12, columns % 24 - 12) < 4

    def dotted(picture: np.ndarray) -> np.ndarray:
        return np.where(dots[..., None], 0.3 * picture, picture).astype(np.uint8)

    error = td.fit(*in_memory(dotted, False), pitch_mm=PITCH, models="cubic", quiet=True).height_errors["cubic"]
    without = found.height_errors["cubic"]
    assert error.presses == without.presses
    assert error.mean == pytest.approx(without.mean, abs=0.02)


@pytest.mark.parametrize(
    ("choices", "message"),
    [
        ({"pitch_mm": (0.1, 0.3)}, "pitch_mm=.*: accepted is pixels 0.5 to 2 times as wide as high"),
        ({"pitch_mm": (0.1, 0.1, 0.1)}, "pitch_mm=.*: accepted are 1e-06 to 1000"),
        ({"models": "quartic"}, "models=quartic: accepted are lut, quadratic, cubic"),
        ({"models": ()}, "models=: accepted are lut, quadratic, cubic"),
        ({"bits": 7}, "bits=7: accepted is a whole number from 1 to 6"),
        ({"pitch_mm": math.nan}, "pitch_mm=nan: accepted are"),
        ({"exposure_us": -1}, "exposure_us=-1: accepted is a time above 0"),
        ({"pitch_mm": 0.12}, "pitch_mm=0.12 contradicts presses"),
    ],
)
def test_bad_arguments_are_named(folder: Path, choices: Any, message: Any) -> None:
    with pytest.raises(InputError, match=message):
        td.fit(folder, **choices)


def test_presses_without_depth_are_refused(presses: Any) -> None:
    flat = [replace(view, press=replace(view.press, ball_radius=1e5)) for view in presses.views]
    with pytest.raises(InputError, match="the steepest press has a slope of"):
        fit_presses(replace(presses, views=tuple(flat)), ("quadratic",))


# evaluate.


def test_an_evaluation_on_the_fitted_presses_is_a_little_better_than_that_of_the_fit(
    sensor: Any, folder: Path, fit: Any, quadratic: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    evaluation = td.evaluate(sensor, folder)
    assert evaluation.presses == fit.evaluation.presses
    for model in MODELS:
        among, alone = (each.values(model, "height_rms_mm").mean() for each in (evaluation, fit.evaluation))
        assert 0.8 * alone < among < 1.01 * alone
    assert evaluation.best_model == sensor.model
    td.fit(folder, models="quadratic")
    view, *summary = capsys.readouterr().out.splitlines()
    assert view.startswith(
        "0.1 mm per pixel: the picture shows 16.0 x 11.2 mm of the gel, an unknown part (no crop) of the sensor's full"
    )
    assert summary == [*quadratic.evaluation.summary.splitlines(), f"verdict: {quadratic.verdict}"]


def test_presses_that_the_picture_cuts_are_left_out_with_a_note(sensor: Any, folder: Path, presses: Any) -> None:
    with pytest.warns(td.InputWarning) as caught:
        evaluation = td.evaluate(sensor, folder)
    cut = [view.press.name for view in presses.views if not view.is_whole]
    assert cut
    assert len(evaluation.presses) == 24 - len(cut)
    assert [note.split(":")[0] for note in evaluation.notes] == cut
    assert evaluation.central == tuple(view.press.is_central for view in presses.views if view.is_whole)
    assert "cuts the contact: left out" in evaluation.notes[0]
    assert all(note in str(evaluation) for note in evaluation.notes)
    assert [Path(warning.filename) for warning in caught] == [Path(__file__)]
    assert str(caught[0].message).startswith(f"{len(cut)} of 24 presses left out: the edge of the picture cuts ")
    assert all(name in str(caught[0].message) for name in cut)


def test_the_table_of_an_evaluation_holds_every_press(sensor: Any, folder: Path) -> None:
    evaluation = td.evaluate(sensor, folder)
    text = str(evaluation)
    assert all(name in text for name in evaluation.presses)
    assert text.endswith(evaluation.summary)
    central = np.array(evaluation.central)
    rms = 1000 * evaluation.values("quadratic", "height_rms_mm")[central].mean()
    assert f"quadratic, {central.sum()} presses in the middle: height RMS in the contact {rms:.1f} um; caps " in text
    assert f"quadratic, {(~central).sum()} presses at the sides: " in text
    assert text.count("at the side\n") == (~central).sum()


def test_larger_pictures_of_the_same_camera_give_nearly_the_same(sensor: Any, folder: Path, tmp_path: Path) -> None:
    """Fit pictures of twice the size, on a grid twice as fine."""
    twice = tmp_path / "twice"
    twice.mkdir()
    for name, picture in pictures().items():
        Image.fromarray(picture.repeat(2, axis=0).repeat(2, axis=1)).save(twice / name)
    rows = [
        {**row, **{key: 2 * row[key] + offset for key, offset in zip(list(row)[2:], (0.5, 0.5, 0, 0), strict=True)}}
        for row in table_rows()
    ]
    write_table(twice, rows)
    small, large = (td.evaluate(sensor, where).height_error("quadratic") for where in (folder, twice))
    assert large.mean == pytest.approx(small.mean, abs=0.02)  # measured: 0.014


def test_an_evaluation_refuses_what_is_not_of_the_sensor(sensor: Any, folder: Path, tmp_path: Path) -> None:
    background = pictures()["background.png"]
    narrow = [td.BallPress(pictures()["00.png"][:, :100], 6.0, (50, 50, 17))]
    with pytest.raises(InputError, match=r"100 x 112 pixels .* calibrated for pictures of 160 x 112"):
        td.evaluate(sensor, narrow, background[:, :100])
    with pytest.raises(InputError, match=r"presses has 0\.05 mm/pixel, which contradicts presses"):
        td.evaluate(replace(sensor, pixel_pitch_mm=PITCH / 2), folder)
    with pytest.raises(InputError, match="presses: none of 1 can be used: press 1: the edge of the picture cuts"):
        td.evaluate(sensor, [td.BallPress(pictures()["00.png"], 6.0, (10, 50, 17))], background)
    with pytest.warns(InputWarning, match="does not look like the sensor of presses"):
        td.evaluate(sensor, [td.BallPress(background, 6.0, (80, 50, 17))], background // np.array((1, 1, 3), np.uint8))
