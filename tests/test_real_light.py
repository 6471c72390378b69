# SPDX-License-Identifier: Apache-2.0
"""The real presses: another light changes neither heights nor areas, and tilts no untouched gel; contact records."""

from typing import Any

import numpy as np
import pytest

import tactile_depth as td
from commands.study.presses import LIGHTS, Measured, in_light, measured
from tactile_depth.calibrate.press_folder import read_presses
from tactile_depth.calibrate.presses import GridPress
from tactile_depth.pictures.frames import read_stack
from tests.ball_presses import real_folder


@pytest.fixture(scope="module")
def real() -> Any:
    return real_folder()


@pytest.fixture(scope="module")
def presses(real: Any) -> list[Any]:
    return read_presses(real)[0]


def on_grid(pipeline: td.Pipeline, press: Any) -> GridPress:
    """Return the geometry of a press on the grid of a pipeline."""
    scale = pipeline.sensor.camera.columns / pipeline.grid[1]  # type: ignore[union-attr]
    x, y, radius = (np.array(press.circle) + np.array([0.5, 0.5, 0])) / scale
    return GridPress(press.name, pipeline.grid, x - 0.5, y - 0.5, radius, press.ball_radius_px / scale)


def measure(pipeline: td.Pipeline, press: Any, result: td.Result) -> Measured:
    return measured(result, on_grid(pipeline, press))


def peak(result: td.Result) -> float:
    return float(result.height_mm.max())


def area(result: td.Result) -> float:
    return result.contact.area_mm2


def mean(values: list[Measured], name: str) -> np.ndarray:
    return np.array([getattr(value, name) for value in values])


@pytest.fixture(scope="module")
def pipeline(real: Any) -> td.Pipeline:
    return td.Pipeline(td.load("gelsight-mini"), real / "background.png")


@pytest.fixture(scope="module")
def quadratic(real: Any) -> td.Pipeline:
    return td.Pipeline(td.load("gelsight-mini"), real / "background.png", model="quadratic")


@pytest.mark.parametrize("model", ["cubic", "quadratic"])
def test_another_light_changes_no_press(
    pipeline: td.Pipeline, quadratic: td.Pipeline, presses: Any, model: str
) -> None:
    """Measured with `cubic`: caps within 0.06 % on average, 1.2 % at worst, areas within 0.11 %."""
    pipeline = {"cubic": pipeline, "quadratic": quadratic}[model]
    same = [measure(pipeline, press, pipeline(press.image)) for press in presses]
    for light in LIGHTS:
        values = [measure(pipeline, press, pipeline(in_light(read_stack(press.image)[0], light))) for press in presses]
        caps = mean(values, "cap") / mean(same, "cap")
        assert abs(caps.mean() - 1) < 0.001, light
        assert np.abs(caps - 1).max() < 0.02, light
        assert (mean(values, "area") / mean(same, "area")).mean() == pytest.approx(1, abs=0.0015), light


def test_the_record_of_a_press_is_that_of_its_circle(pipeline: td.Pipeline, presses: Any) -> None:
    """Measured: one contact each; centroids 0.066 mm off on average, 0.269 at worst; areas 0.76 to 1.14 of the
    circle's, 0.97 on average.

    docs/accuracy.md states these numbers, and those of all that is above the threshold.
    """
    found: dict[str, list[tuple[float, float]]] = {"area": [], "mask": []}
    for press in presses:
        result, ball = pipeline(press.image), on_grid(pipeline, press)
        value = measured(result, ball)
        assert len(result.contacts) == 1, press.name
        found["area"].append((value.centroid, value.area))
        row, column = np.argwhere(result.mask).mean(axis=0)
        off = np.hypot(row - ball.y - 0.5, column - ball.x - 0.5) * pipeline.pixel_pitch_mm
        found["mask"].append((off, result.mask.sum() / (np.pi * ball.contact_radius**2)))
    (off, area), (all_off, all_area) = (np.transpose(values) for values in found.values())
    assert off.mean() < 0.07
    assert off.max() < 0.28
    assert 0.96 < area.mean() < 0.98
    assert area.min() > 0.75
    assert area.max() < 1.15
    assert (all_off.mean(), all_off.max()) == pytest.approx((0.27, 0.99), abs=0.01)
    assert (all_area.mean(), all_area.min(), all_area.max()) == pytest.approx((1.82, 1.27, 2.46), abs=0.01)


def test_more_light_is_read_as_contact_without_light_gains(real: Any, presses: Any) -> None:
    """Compare peak and area, mean over presses, with 5 % more light. docs/light.md states these numbers."""
    sensor, found = td.load("gelsight-mini"), {}
    for on in (False, True):
        pipeline = td.Pipeline(sensor, real / "background.png", light_gains=on)
        for light in (1, 1.05):
            results = [pipeline(in_light(read_stack(press.image)[0], (light,) * 3)) for press in presses]
            peaks, areas = ([each(result) for result in results] for each in (peak, area))
            found[on, light] = np.mean(peaks), np.mean(areas)
    assert found[False, 1] == pytest.approx((0.832, 10.8), rel=0.01)
    assert found[False, 1.05] == pytest.approx((1.11, 41.1), rel=0.01)
    assert found[True, 1] == pytest.approx((0.816, 10.5), rel=0.01)
    assert found[True, 1.05] == pytest.approx(found[True, 1], rel=0.001)


def test_light_gains_take_the_tilt_off_untouched_gel(real: Any, pipeline: td.Pipeline, presses: Any) -> None:
    """Measured: 0.0210 mm RMS and 0.112 mm at most, mean over presses; without light gains 0.046 and 0.169 mm."""
    without = td.Pipeline(td.load("gelsight-mini"), real / "background.png", light_gains=False)
    tilted, level = ([measure(each, press, each(press.image)) for press in presses] for each in (without, pipeline))
    assert mean(level, "rest_rms").mean() < 0.022
    assert mean(level, "rest_largest").mean() < 0.115
    assert mean(level, "rest_rms").mean() < 0.5 * mean(tilted, "rest_rms").mean()


@pytest.mark.parametrize(("model", "frames"), [("cubic", (3, 5)), ("quadratic", (2, 4))])
@pytest.mark.parametrize("light", [0.9, 0.95, 1.05, 1.1, 0.8, 1.2])
def test_a_step_of_the_light_is_followed_under_a_contact(
    pipeline: td.Pipeline, quadratic: td.Pipeline, presses: Any, light: float, model: str, frames: tuple[int, int]
) -> None:
    """Caps are back within 3 % after so many frames of the new light, within 10 % and beyond."""
    pipeline, needed = {"cubic": pipeline, "quadratic": quadratic}[model], frames[abs(light - 1) > 0.11]
    ratios = []
    for press in presses[::5]:
        image, lit = read_stack(press.image)[0], in_light(read_stack(press.image)[0], (light,) * 3)
        *_, before = pipeline.stream([image] * 6)
        *_, after = pipeline.stream([*[image] * 6, *[lit] * needed, lit])
        caps = [measure(pipeline, press, result).cap for result in (before, after)]
        ratios.append(caps[1] / caps[0])
    assert np.abs(np.array(ratios) - 1).max() < 0.03, ratios
    assert np.mean(ratios) == pytest.approx(1, abs=0.015)
