# SPDX-License-Identifier: Apache-2.0
"""Fixtures that run a command as its command line does."""

from collections.abc import Callable
from typing import Any, NamedTuple

import pytest

from commands import __main__ as entry


class Ended(NamedTuple):
    """End of a command: its exit status, its output, and the lines on stderr without the notice of a first build."""

    status: int
    output: str
    errors: list[str]


@pytest.fixture
def run_command(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Callable[..., Ended]:
    """Run `python -m commands` with these words."""

    def run(*words: Any) -> Ended:
        monkeypatch.setattr("sys.argv", ["commands", *words])
        status = 0
        try:
            entry.main()
        except SystemExit as ended:
            status = int(ended.code or 0)
        output, errors = capsys.readouterr()
        return Ended(status, output, [line for line in errors.splitlines() if not line.startswith("building the ")])

    return run


@pytest.fixture
def refused(run_command: Callable[..., Ended]) -> Callable[..., str]:
    """Run a command that must end with status 2 and one line; return the line."""

    def run(*words: Any) -> str:
        ended = run_command(*words)
        assert (ended.status, ended.output, len(ended.errors)) == (2, "", 1), ended
        return ended.errors[0]

    return run
