# SPDX-License-Identifier: Apache-2.0
"""Moving picture of the README: it is what `make figures` draws, small, and its frames say what they show."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from commands.common import press_data
from commands.study import press_film
from tests.real_data import FOLDER, needs_real_data

LARGEST_BYTES = 1_500_000
LEVELS = 2  # grey levels by which letters and scaled pictures may differ between machines, on average


def frames_of(path: Path) -> tuple[list[np.ndarray], list[float]]:
    """Return the frames of a moving picture and their times in ms."""
    frames, times = [], []
    with Image.open(path) as film:
        for number in range(getattr(film, "n_frames", 1)):
            film.seek(number)
            frames.append(np.asarray(film.convert("RGB"), float))
            times.append(film.info["duration"])
    return frames, times


def test_the_film_is_small_and_comes_and_leaves() -> None:
    assert press_film.FILM.stat().st_size <= LARGEST_BYTES
    frames, times = frames_of(press_film.FILM)
    assert len(frames) == len(press_film.STEPS)
    assert {frame.shape[1] for frame in frames} == {760}
    longest = [share for (*_, share), time in zip(press_film.STEPS, times, strict=True) if time == max(times)]
    assert longest == [1.0] * len(press_film.PRESSES), "the pictures that are no blends are shown longest"


@needs_real_data
def test_the_film_is_current(tmp_path: Path) -> None:
    press_film.draw(FOLDER / "gelslam", tmp_path / "film.png")
    (drawn, times), (shown, shown_times) = frames_of(tmp_path / "film.png"), frames_of(press_film.FILM)
    assert times == shown_times, "run make figures"
    off = [float(np.abs(a - b).mean()) for a, b in zip(drawn, shown, strict=True)]
    assert max(off) < LEVELS, "run make figures"


@needs_real_data
def test_every_frame_says_what_it_shows() -> None:
    each = list(press_film.moments(FOLDER / "gelslam"))
    assert [moment.result.contact.touching for moment in each] == [share > 0 for *_, share in press_film.STEPS]
    blends = [moment.title.startswith("blend") for moment in each]
    assert blends == [share not in {0, 1} for *_, share in press_film.STEPS]
    highest = max(moment.result.height_mm.max() for moment in each)
    assert highest < press_film.TOP_MM, "beyond the end of the scale"


def test_without_presses_the_film_stays(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("TACTILE_DATA", str(tmp_path))
    before = press_film.FILM.read_bytes()
    assert press_film.draw_if_there().startswith("docs/film.png stays as it is: no presses")
    assert press_film.FILM.read_bytes() == before
    assert press_data.PUBLIC_PRESSES in press_film.draw_if_there()
