# SPDX-License-Identifier: Apache-2.0
"""Checks of a reference by the calibration's own picture: another view, and contact, on a Mini, a DIGIT, and drawn."""

import contextlib
import re
import warnings
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from PIL import Image

import tactile_depth as td
from tactile_depth.calibrate.press_folder import read_presses
from tactile_depth.pictures.doubts import UnusablePicture
from tactile_depth.pictures.frames import read_picture
from tactile_depth.pictures.reference_check import check_reference
from tactile_depth.pictures.view_check import shares_shown
from tactile_depth.sensor.sensor import equal_areas, lighting
from tests import real_data
from tests.ball_presses import real_folder

X, Y = np.linspace(-1, 1, 320)[None, :, None], np.linspace(-1, 1, 240)[:, None, None]
VIEWS = (0.95, 0.9, 0.8, 0.71)
DENTED = "as if something touched the gel"
Own = tuple[td.Sensor, np.ndarray, list[np.ndarray]]


def levels(picture: np.ndarray) -> np.ndarray:
    return np.clip(np.rint(picture), 0, 255).astype(np.uint8)


def noisy(picture: np.ndarray, light: Any = 1, noise: float = 1, seed: int = 1) -> np.ndarray:
    return levels(picture * np.asarray(light) + np.random.default_rng(seed).normal(0, noise, picture.shape))


def view(picture: np.ndarray, share: float) -> np.ndarray:
    """Return the middle of a picture in its size."""
    return squeezed(picture, share, share)


def squeezed(picture: np.ndarray, across: float, down: float) -> np.ndarray:
    """Return the middle of a picture, shares of its width and height, in its size."""
    rows, columns = picture.shape[:2]
    height, width = round(rows * down), round(columns * across)
    x, y = (columns - width) // 2, (rows - height) // 2
    cut = Image.fromarray(picture).crop((x, y, x + width, y + height))
    return np.asarray(cut.resize((columns, rows), Image.Resampling.BILINEAR))


def calibrated_on(sensor: td.Sensor, picture: np.ndarray, share: float) -> td.Sensor:
    """Return a sensor whose calibration's own picture without contact is another one."""
    return replace(sensor, untouched=equal_areas(picture), lighting=lighting(picture), view=(share, share))


def smooth_light(seed: int) -> np.ndarray:
    """Return a picture without contact of a drawn sensor."""
    chance, picture = np.random.default_rng(seed), np.zeros((240, 320, 3))
    for power in ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2)):
        picture += chance.normal(0, 0.25, 3) * X ** power[0] * Y ** power[1]
    return noisy(np.exp(picture) * 90)


def specimen(picture: np.ndarray, seed: int) -> np.ndarray:
    """Return what another specimen may show: light moved by 2 mm, changed by 5 to 15 %, other lamps, another hue."""
    chance = np.random.default_rng(seed)
    pattern = sum(
        chance.normal(size=3) * np.cos(a * 1.5 * X + b * 1.5 * Y + chance.uniform(0, 6))
        for a in range(3)
        for b in range(3)
    )
    pattern *= chance.uniform(0.05, 0.15) / np.abs(pattern).max()
    y, x = chance.integers(0, 65, 2)
    moved = np.pad(picture, ((32, 32), (32, 32), (0, 0)), mode="edge")[y : y + 240, x : x + 320]
    angle = chance.uniform(-0.3, 0.3)
    hue = np.eye(3) * np.cos(angle) + (1 - np.cos(angle)) / 3
    hue += np.sin(angle) / np.sqrt(3) * np.array([[0, -1, 1], [1, 0, -1], [-1, 1, 0]])
    return noisy(0.8 * np.maximum(moved @ hue.T, 5) * (1 + pattern) * chance.uniform(0.75, 1.25, 3))


@pytest.fixture(scope="module")
def mini() -> Own:
    folder = real_folder()
    presses = [read_picture(press.image) for press in read_presses(folder)[0]]  # type: ignore[arg-type]
    return td.load("gelsight-mini"), read_picture(folder / "background.png"), presses


@pytest.fixture(scope="module")
def digit() -> Own:
    folder = real_data.FOLDER / "fots_digit"
    if not folder.is_dir():
        pytest.skip("TACTILE_DATA names no folder with fots_digit/")
    background, *presses = (
        np.rot90(read_picture(path)) for path in [folder / "background.png", *sorted(folder.glob("0*.png"))]
    )
    return calibrated_on(td.load("gelsight-mini"), background, 1), background, presses


@pytest.fixture(scope="module")
def drawn() -> Own:
    picture = smooth_light(1)
    return calibrated_on(td.load("gelsight-mini"), picture, 1), picture, []


@pytest.fixture(params=["mini", "digit", "drawn"])
def own(request: pytest.FixtureRequest) -> Own:
    result: Own = request.getfixturevalue(request.param)
    return result


def doubts(sensor: td.Sensor, reference: np.ndarray) -> str:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return "; ".join(map(str, check_reference(sensor, reference[None])))


RIGHT: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "itself": lambda p: p,
    "noise": lambda p: noisy(p, noise=2),
    "0.8 of the light": lambda p: noisy(p, 0.8),
    "1.1 of the light": lambda p: levels(1.1 * p),
    "two colours": lambda p: noisy(p, (1.05, 1, 0.95)),
    "half the exposure": lambda p: levels(0.5 * p),
    "a plane of light": lambda p: noisy(p, 1 + 0.02 * X * (1, 0, -1) - 0.01 * Y),
    "0.97 of the view": lambda p: view(p, 0.97),
}


@pytest.mark.parametrize("kind", RIGHT)
def test_a_right_reference_is_certain(own: Own, kind: str) -> None:
    sensor, background, _ = own
    assert doubts(sensor, RIGHT[kind](background)) == ""


@pytest.mark.parametrize("share", VIEWS)
def test_a_reference_of_a_smaller_view_names_the_crop(own: Own, share: float) -> None:
    sensor, background, _ = own
    assert sensor.view is not None
    for light in (1, (0.8, 1, 1.1), 1 + 0.01 * X):
        text = doubts(sensor, noisy(view(background, share), light))
        assert "heights are too large" in text
        crop = re.search(r"give crop=(\S+),", text)
        assert crop
        named = {"gs_sdk": 5 / 7, "gsrobotics": 0.70}.get(crop[1]) or float(crop[1])
        assert named == pytest.approx(sensor.view[0] * share, rel=0.02), text


@pytest.mark.parametrize(("width", "height"), [(0.75, 1), (1, 0.75), (0.9, 1), (1, 0.95), (0.9, 0.8)])
def test_a_squeezed_reference_names_the_size_and_the_crop(mini: Own, digit: Own, width: float, height: float) -> None:
    for sensor, background, _ in (mini, digit):
        assert sensor.view is not None
        text = doubts(sensor, noisy(squeezed(background, width, height), (0.8, 1, 1.1)))
        named = re.search(
            r"heights are wrong: resize the pictures to (\d+) x (\d+) and give crop=(.+),(.+), what", text
        )
        assert named, text
        columns, rows, *crop = map(float, named.groups())
        assert crop == pytest.approx((sensor.view[0] * width, sensor.view[1] * height), rel=0.02)
        assert columns / rows == pytest.approx(4 / 3 * width / height, rel=0.03)


@pytest.mark.parametrize("share", [*VIEWS, 5 / 7])
def test_a_reference_of_a_larger_view_names_the_crop(own: Own, share: float) -> None:
    sensor, background, _ = own
    text = doubts(calibrated_on(sensor, view(background, share), share), noisy(background, 0.9))
    assert "heights are too small: give crop=none" in text
    unknown = replace(calibrated_on(sensor, view(background, share), share), view=None)
    assert "give pictures that show as much of the gel" in doubts(unknown, background)


@pytest.mark.parametrize("seed", range(12))
def test_another_specimen_is_no_other_view(own: Own, seed: int) -> None:
    sensor, background, _ = own
    assert sensor.untouched is not None
    for other in (specimen(background, seed), smooth_light(seed + 2)):
        assert shares_shown(other, sensor.untouched) == (1, 1)
        with contextlib.suppress(UnusablePicture):  # as an exchange of sides
            assert DENTED not in doubts(sensor, other)


TONES: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "gamma 0.9": lambda p: 255 * (p / 255) ** 0.9,
    "gamma 1.1": lambda p: 255 * (p / 255) ** 1.1,
    "4 levels brighter": lambda p: p + 4,
    "10 levels darker": lambda p: p - 10,
    "more contrast": lambda p: 128 + 1.1 * (p - 128),
    "less saturation": lambda p: p + 0.1 * (p.mean(axis=-1, keepdims=True) - p),
    "limited range": lambda p: 16 + p * 219 / 255,
    "limited range expanded twice": lambda p: (p - 16) * 255 / 219,
    "40 levels darker": lambda p: p - 40,
    "much contrast": lambda p: 128 + 1.4 * (p - 128),
}


@pytest.mark.parametrize("tone", TONES)
def test_another_tone_of_the_camera_is_warned_of(mini: Own, tone: str) -> None:
    sensor, background, _ = mini
    text = "another gamma, brightness, contrast or saturation"
    assert text in doubts(sensor, levels(TONES[tone](background.astype(np.float64))))
    for right in (
        background,
        levels(0.85 * background),
        noisy(background),
        levels(background * (1 + 0.05 * X)),
    ):
        assert text not in doubts(sensor, right)


@pytest.mark.parametrize("side", [X, -X, Y, -Y])
def test_light_from_a_side_is_warned_of(mini: Own, side: np.ndarray) -> None:
    sensor, background, _ = mini
    for added in (8, 16):
        assert "light falls in from a side" in doubts(sensor, levels(background + added * (side + 1) / 2))
    assert "a side" not in doubts(sensor, levels(background * (1 + 0.1 * side)))


def test_a_reference_that_is_dark_in_part_is_warned_of(mini: Own) -> None:
    sensor, background, _ = mini
    assert "of it have a colour below 16 of 255, their slopes are lost" in doubts(sensor, levels(0.4 * background))


@pytest.mark.parametrize("seed", range(8))
def test_another_specimen_is_no_other_tone(own: Own, seed: int) -> None:
    sensor, background, _ = own
    with contextlib.suppress(UnusablePicture):
        told = doubts(sensor, specimen(background, seed))
        assert "gamma" not in told
        assert "a side" not in told


def dented(background: np.ndarray, press: np.ndarray, share: float) -> np.ndarray:
    return levels(background + share * (press.astype(np.float64) - background))


@pytest.mark.parametrize(("share", "least"), [(0.1, 0.95), (0.2, 1), (0.3, 1)])
def test_a_dent_in_the_reference_is_warned_of(mini: Own, digit: Own, share: float, least: float) -> None:
    for sensor, background, presses in (mini, digit):
        seen = [DENTED in doubts(sensor, dented(background, press, share)) for press in presses]
        assert np.mean(seen) >= least
        if share == 0.2:
            assert all(DENTED in doubts(sensor, noisy(dented(background, press, share))) for press in presses)


@pytest.mark.parametrize("seed", range(8))
def test_a_drawn_dent_is_warned_of(drawn: Own, seed: int) -> None:
    sensor, background, _ = drawn
    chance = np.random.default_rng(seed)
    x, y, radius = chance.uniform(-0.7, 0.7), chance.uniform(-0.7, 0.7), chance.uniform(0.12, 0.2)
    offset = np.stack(np.broadcast_arrays((X - x) * 4 / 3, Y - y), axis=-1)[:, :, 0] / radius
    distance = np.hypot(*np.moveaxis(offset, -1, 0))[..., None]
    steepness = 0.2 * 0.5 * np.where(distance < 1, 1, np.exp(3 * (1 - distance)))
    colours = offset @ np.array([[0.55, -0.35, -0.25], [0.1, 0.5, -0.55]]) * steepness
    assert DENTED in doubts(sensor, noisy(background, 1 - colours))


def test_a_reference_in_another_view_is_identified(mini: Own) -> None:
    for share in (1, 0.9, 0.6):
        assert td.identify(view(mini[1], share)).name == "gelsight-mini"


def test_a_calibration_without_its_picture_has_the_limit_of_one_mini(mini: Own) -> None:
    sensor, background, presses = mini
    old = replace(sensor, untouched=None)
    assert doubts(old, background) == ""
    assert DENTED in doubts(old, presses[0])
