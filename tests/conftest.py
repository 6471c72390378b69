# SPDX-License-Identifier: Apache-2.0
"""Ball presses and pipelines that tests share and none changes."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import tactile_depth as td
from tactile_depth.calibrate.presses import GridPresses
from tests.ball_presses import read, write_folder

SMALL = (24, 32)


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of all drawn presses."""
    return write_folder(tmp_path_factory.mktemp("ball") / "presses")


@pytest.fixture(scope="session")
def presses(folder: Path) -> GridPresses:
    return read(folder)


@pytest.fixture(scope="module")
def ball() -> td.Sample:
    return td.sample("ball")


@pytest.fixture(scope="module")
def pipeline(ball: td.Sample) -> td.Pipeline:
    return td.Pipeline(ball.sensor, ball.reference)


@pytest.fixture(scope="module")
def small(ball: td.Sample) -> td.Pipeline:
    return td.Pipeline(ball.sensor, ball.reference, grid=SMALL)


@pytest.fixture
def press_keys(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """Press keys: a word of letters, one before each frame, "." for none."""

    def press(letters: str) -> None:
        @contextmanager
        def keys() -> Iterator[Callable[[], str]]:
            left = iter(letters)
            yield lambda: next(left, "").replace(".", "")

        monkeypatch.setattr("tactile_depth.cli.live.pressed_keys", keys)

    return press
