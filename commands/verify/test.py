# SPDX-License-Identifier: Apache-2.0
"""`make test`: lint and the whole suite. CORE=a,b: lint and tests of these cores alone, SIM=icarus: on one simulator.

Exit status: docs/exit-status.md.
"""

import os
import subprocess
import sys
from collections.abc import Sequence

from commands.common import repository, variables
from commands.common.simulator import SIMULATORS

REPORTS = ("--junitxml=build/junit.xml", "--durations=10", "--durations-min=20")
WIDE = {"COLUMNS": "200"}  # so that the summary shows the whole message
ONE_POWER_UP = {"POWER_UPS": "1"}  # the whole suite runs each core from a second random power-up state too


def lint(cores: Sequence[str] = ()) -> list[str]:
    """Return the command that lints these cores, or everything."""
    chosen = [f"CORE={','.join(cores)}"] if cores else []
    return [sys.executable, "-m", "commands", "lint", *chosen]


def pytest(tests: Sequence[str] = (), *, workers: str = "auto") -> list[str]:
    """Return the command that runs these test files, or the whole suite."""
    return [sys.executable, "-m", "pytest", "-n", workers, "--dist", "worksteal", *REPORTS, *tests]


def tests_of(cores: Sequence[str]) -> list[str]:
    """Return the test files of cores, relative to the root of the repository."""
    files = [repository.cores()[core].test for core in repository.tested(cores)]
    return [str(file.relative_to(repository.ROOT)) for file in files if file]


def all_succeed(processes: Sequence[Sequence[str]], **environment: str) -> bool:
    """Run processes one after the other up to the first failure, and return whether all of them succeeded."""
    return all(
        subprocess.run(process, cwd=repository.ROOT, env=os.environ | WIDE | environment, check=False).returncode == 0
        for process in processes
    )


def main() -> None:
    with variables.reported("test"):
        values = variables.given(sys.argv[1:], ("CORE", "SIM"))
        environment = {}
        if "SIM" in values:
            environment["SIM"] = variables.choice(values, "SIM", SIMULATORS)
        if "CORE" in values:
            cores = repository.chosen(values["CORE"])
            processes = [pytest(tests_of(cores)), lint(cores)]  # a wrong result is more important than style
            environment |= ONE_POWER_UP
        else:
            processes = [lint(), pytest()]
        if not all_succeed(processes, **environment):
            raise variables.Mismatch("failed: see above")
