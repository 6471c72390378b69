# SPDX-License-Identifier: Apache-2.0
"""Signals at random moments: no folder stays behind, and whatever exception arrives is reported as the signal."""

import contextlib
import random
import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from commands.common import signals, variables
from tactile_depth.base import files, interruption
from tactile_depth.cli import main
from tactile_depth.pictures import frames
from tb.settings import RUN

INTERRUPTIONS = 2500 if RUN.full else 500
LONGEST_S = 1e-3  # until a signal: a few workspaces, and a few arrays that are read
TEXT = "terminated by SIGTERM\n"
pytestmark = pytest.mark.seeds


@pytest.fixture
def start_timer() -> Iterator[Callable[[], None]]:
    """Return a function that starts a timer, which sends SIGTERM after a random time."""
    seed = random.randrange(2**32)
    print(f"seed {seed}")
    rng = random.Random(seed)

    def start() -> None:
        signal.setitimer(signal.ITIMER_REAL, rng.uniform(1e-5, LONGEST_S))

    before = signal.signal(signal.SIGALRM, lambda *_: signal.raise_signal(signal.SIGTERM))
    yield start
    signal.setitimer(signal.ITIMER_REAL, 0)
    signal.signal(signal.SIGALRM, before)


@pytest.fixture
def read(tmp_path: Path, start_timer: Callable[[], None]) -> Callable[..., None]:
    """Return a function that reads an array again and again until the timer ends it.

    numpy turns some of the interruptions into a TypeError, which frames.py takes for a damaged array.
    """
    np.save(tmp_path / "pictures.npy", np.zeros((1, 4, 4, 3), np.uint8))

    def read_until_interrupted(*_: Any) -> None:
        start_timer()
        while not interruption.received():
            frames._read_array(tmp_path / "pictures.npy")

    return read_until_interrupted


def test_a_signal_leaves_no_folder(tmp_path: Path, start_timer: Callable[[], None]) -> None:
    for interruptions in range(INTERRUPTIONS):
        with contextlib.suppress(interruption.Stopped), interruption.stoppable():
            start_timer()
            while not interruption.received():  # an exception in a callback of a library is lost
                with files.workspace(tmp_path / "new" / "out", ["report.json"], keep=RuntimeError) as work:
                    (work / "report.json").touch()
        assert list(tmp_path.rglob("*")) == [], f"after {interruptions + 1} interruptions"


def test_the_program_reports_every_signal(
    read: Callable[..., None], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(main, "_parser", lambda: SimpleNamespace(parse_args=lambda _: SimpleNamespace(run=read)))
    statuses = {main.main([]) for _ in range(INTERRUPTIONS)}
    assert capsys.readouterr().err == f"tactile-depth: {TEXT}" * INTERRUPTIONS
    assert statuses == {128 + signal.SIGTERM}


def test_a_command_reports_every_signal(
    read: Callable[..., None], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(signals, "end_children", lambda: None)  # there are none, and a search takes milliseconds
    for _ in range(INTERRUPTIONS):
        with pytest.raises(SystemExit) as ended, variables.reported("sim"):
            read()
        assert ended.value.code == 128 + signal.SIGTERM
    assert capsys.readouterr().err == f"make sim: {TEXT}" * INTERRUPTIONS


def test_a_signal_that_was_swallowed_ends_the_block() -> None:
    with pytest.raises(interruption.Stopped) as stopped, interruption.stoppable(), contextlib.suppress(BaseException):
        signal.raise_signal(signal.SIGTERM)
    assert stopped.value.number == signal.SIGTERM
    assert interruption.received() is None
