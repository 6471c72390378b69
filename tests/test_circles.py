# SPDX-License-Identifier: Apache-2.0
"""Circles of contacts: of real presses, and of drawn ones that are faint, deep, at the border or on a marked gel.

Circles are numbers of pixels. circles_digit.csv: drawn by eye around the bright faces of 14 contacts, enlarged, after
subtraction of the background, in pictures rotated by 90 degrees counterclockwise; radii by eye are good to 3 pixels.
circles_mini.csv: found by an earlier version, whose circles the shipped calibration was checked with.
"""

import csv
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import tactile_depth as td
from tactile_depth.calibrate.ball_press import Circle
from tactile_depth.calibrate.circles import find_circle
from tactile_depth.calibrate.press_pictures import gather
from tactile_depth.calibrate.presses import to_grid
from tests.ball_presses import PITCH, drawn
from tests.real_data import FOLDER, needs_real_data

DIGIT, MINI = FOLDER / "fots_digit", FOLDER / "gelslam"
DIGIT_BALL_PX = 4.7 / 2 * 19.58
needs_digit = pytest.mark.skipif(not DIGIT.is_dir(), reason="TACTILE_DATA names no folder with fots_digit/")
Change = Callable[[np.ndarray], np.ndarray]


def circles(name: str) -> dict[str, Circle]:
    with (Path(__file__).parent / name).open(encoding="utf-8") as file:
        return {row.pop("frame"): Circle(*map(float, row.values())) for row in csv.DictReader(file)}


def picture(path: Path, rotate: int = 0) -> np.ndarray:
    return np.ascontiguousarray(np.rot90(np.asarray(Image.open(path).convert("RGB")), rotate // 90))


def off(seen: Circle, true: Circle) -> float:
    """Return the larger of the distance of the centres and the difference of the radii."""
    return max(math.hypot(seen.x - true.x, seen.y - true.y), abs(seen.radius - true.radius))


def noisy(image: np.ndarray) -> np.ndarray:
    grain = np.random.default_rng(1).normal(scale=5, size=image.shape)
    return np.clip(np.rint(image + grain), 0, 255).astype(np.uint8)


@needs_digit
@pytest.mark.parametrize("change", [lambda image: image, noisy, lambda image: image // 2], ids=["", "noise", "dark"])
def test_circles_of_a_digit_are_those_drawn_by_eye(change: Change) -> None:
    """Measured: all 14, at worst 0.14 of the radius off."""
    background = change(picture(DIGIT / "background.png", 90))
    right = 0
    for frame, true in circles("circles_digit.csv").items():
        found = find_circle(change(picture(DIGIT / frame, 90)), background, DIGIT_BALL_PX)
        assert found is not None, frame
        assert found.stretch is None, f"{frame}: it has no sharp edge"
        right += off(found.circle, true) < 0.15 * true.radius
    assert right == 14


@needs_real_data
@pytest.mark.parametrize("ball", [1.0, 1.5], ids=["", "ball too large"])
def test_no_circle_of_a_mini_moves(ball: float) -> None:
    """Measured: by 0.11 pixels at most."""
    background = picture(MINI / "background.png")
    for frame, before in circles("circles_mini.csv").items():
        found = find_circle(picture(MINI / frame), background, ball * float(frame.split("mm")[0]) / 2 / 0.0634)
        assert found is not None, frame
        assert off(found.circle, before) < 0.5, frame
        assert found.stretch is not None


@needs_digit
@needs_real_data
def test_no_circle_is_found_beside_the_contact() -> None:
    """Paint the background over each contact: what is left of a press is no circle."""
    chance = np.random.default_rng(1)
    for folder, name, rotate in ((DIGIT, "circles_digit.csv", 90), (MINI, "circles_mini.csv", 0)):
        background = picture(folder / "background.png", rotate)
        for frame, (x, y, radius) in circles(name).items():
            rows, columns = np.indices(background.shape[:2])
            contact = (np.hypot(columns - x, rows - y) < 3 * radius)[..., None]
            untouched = background + chance.normal(size=background.shape)
            left = np.where(contact, untouched, picture(folder / frame, rotate))
            assert find_circle(np.clip(np.rint(left), 0, 255).astype(np.uint8), background, 60) is None, frame


@pytest.mark.parametrize(
    ("x", "y", "contact", "ball"),
    [
        (70, 60, 10, 35),  # light
        (90, 50, 18, 90),  # light and of a large ball
        (70, 50, 26, 30),  # deep
        (60, 55, 28, 32),
        (9, 50, 20, 40),  # cut by the border
        (150, 100, 20, 40),
    ],
)
@pytest.mark.parametrize("spots", [False, True], ids=["plain", "markers"])
def test_drawn_circles_are_found(x: float, y: float, contact: float, ball: float, spots: bool) -> None:
    image, background = drawn([(x, y, contact, ball)], 3), drawn([], 1)
    if spots:
        rows, columns = np.indices(image.shape[:2])
        spot = np.hypot(rows % 24 - 12, columns % 24 - 12) < 3
        image, background = (np.where(spot[..., None], 3 * (each // 10), each) for each in (image, background))
    found = find_circle(image, background, ball)
    assert found is not None
    assert off(found.circle, Circle(x, y, contact)) < 0.15 * contact


@pytest.mark.parametrize("grain", [0, 1, 4, 8])
@pytest.mark.parametrize("drift", [0, 0.05, -0.2])
def test_no_circle_is_found_in_noise_and_drifting_light(grain: float, drift: float) -> None:
    background = drawn([], 1)
    chance = np.random.default_rng(int(8 * grain))
    across = np.linspace(-1, 1, background.shape[1])[None, :, None] * (1, 0.3, -1)
    image = background * (1 + drift * across) + chance.normal(scale=grain, size=background.shape)
    assert find_circle(np.clip(np.rint(image), 0, 255).astype(np.uint8), background, 40) is None


def test_a_circle_larger_than_the_ball_tells_of_a_wrong_diameter_or_pitch() -> None:
    presses = [td.BallPress(drawn([(70, 50, 25, 30)], 3), diameter, name=f"{diameter}") for diameter in (6.0, 4.0)]
    notes = to_grid(gather(presses, drawn([], 1)), PITCH).notes
    assert len(notes) == 1
    assert notes[0].startswith("4.0: a contact of 2")
    assert "mm) does not lie on a ball of radius 20.0 pixels (2.00 mm): diameter or pitch is wrong" in notes[0]
