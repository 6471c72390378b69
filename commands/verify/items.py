# SPDX-License-Identifier: Apache-2.0
"""Tests of pytest that a command runs: what each recorded, in a table below the progress, and the exit status."""

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import pytest

from commands.common import variables
from commands.common.repository import ROOT
from tb.settings import RunSettings

# A command leaves no state for the next run of pytest.
OPTIONS = (f"--rootdir={ROOT}", *["-p", "no:cacheprovider", "--dist", "worksteal", "--no-summary", "--timeout=3600"])
LINT = "tests/commands/test_lint.py::test_nothing_is_found"
STATUS = {
    pytest.ExitCode.OK: variables.EQUAL,
    pytest.ExitCode.TESTS_FAILED: variables.MISMATCH,
    pytest.ExitCode.NO_TESTS_COLLECTED: variables.BAD_INPUT,
}


@dataclass(frozen=True)
class Item:
    """Outcome of a test: what it gave to `record_property`, and the message of its failure, "" if it passed."""

    name: str
    failure: str
    seconds: float
    recorded: dict[str, Any] = field(default_factory=dict)


class Table:
    """Plugin that collects the items, and prints their table at the end."""

    def __init__(self, text: Callable[[Sequence[Item]], str]) -> None:
        self.items: list[Item] = []
        self.text = text

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.when == "call" or not report.passed:
            failure = "" if report.passed else report.longreprtext or report.outcome
            self.items.append(Item(report.nodeid, failure, report.duration, dict(report.user_properties)))

    def pytest_terminal_summary(self, terminalreporter: Any) -> None:
        if text := self.text(self.items):
            terminalreporter.write_line(text)


def run(
    tests: Sequence[str],
    text: Callable[[Sequence[Item]], str],
    *,
    marks: str = "",
    workers: int | str = "auto",
    verbose: bool = False,
    settings: RunSettings | None = None,
    **environment: str,
) -> tuple[int, list[Item]]:
    """Run tests, with `marks` in place of the marks that are left out by default; return exit status and items.

    `verbose` shows each test as it ends.

    Raises KeyboardInterrupt: a signal ended the run. RuntimeError: pytest failed.
    """
    os.environ.update((settings or RunSettings()).environment | environment)  # its workers inherit it
    table = Table(text)
    arguments = [*OPTIONS, "-n", str(workers), *["-vv"] * verbose, "-m", marks, *tests]
    status = pytest.main(arguments, plugins=[table])
    if status == pytest.ExitCode.INTERRUPTED:
        raise KeyboardInterrupt
    if status not in STATUS:
        raise RuntimeError(f"pytest ended with status {int(status)}: see above")
    return STATUS[pytest.ExitCode(status)], table.items
