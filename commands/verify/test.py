# SPDX-License-Identifier: Apache-2.0
"""`make test`: lint and the whole suite. CORE=a,b: lint and tests of these cores alone, SIM=icarus: on one simulator.

Exit status: docs/exit-status.md.
"""

import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from commands.common import repository
from commands.common.simulator import Simulator
from commands.common.variables import Mismatch
from commands.verify.items import LINT
from tb.settings import RunSettings

OPTIONS = ("--dist", "worksteal", "-p", "no:benchmark")
REPORTS = ("--junitxml=build/junit.xml", "--override-ini=junit_family=xunit1", "--durations=10", "--durations-min=20")
WIDE = {"COLUMNS": "200"}  # so that the summary shows the whole message
KEPT = {"PYTHONDONTWRITEBYTECODE": ""}  # or each process would rewrite the assertions of all tests again
WORKERS = str(len(os.sched_getaffinity(0)) + 1)  # one more than cores, because tests of lines and signals wait
WITH_LINT = "not regress and not codes and not netlist"


def pytest(tests: Sequence[str] = (), workers: str = WORKERS) -> list[str]:
    """Return the command that runs these tests, or the whole suite, and lint if it is among them."""
    return [sys.executable, "-m", "pytest", "-n", workers, *OPTIONS, *REPORTS, "-m", WITH_LINT, *tests]


def tests_of(cores: Sequence[str]) -> list[str]:
    """Return the testbenches of cores and the tests of their models, and the checks of lint."""
    files: list[Path] = []
    for core in (repository.cores()[name] for name in repository.tested(cores)):
        files += core.benches if len(core.benches) == 1 else ()
        files.append(repository.ROOT / "tests" / core.block / f"test_{core.name}.py")
    return [*(str(file.relative_to(repository.ROOT)) for file in files if file.is_file()), LINT]


def workers_for(cores: Sequence[str]) -> str:
    """Return the number of processes for cores: a core inside others has run before a second one has begun."""
    return "0" if len(cores) == 1 and cores[0] not in repository.outermost() else WORKERS


def settings(cores: Sequence[str]) -> dict[str, str]:
    """Return the settings of a run of some cores, as an environment: lint checks them alone."""
    return RunSettings(cores=tuple(cores)).environment


def all_succeed(processes: Sequence[Sequence[str]], environment: Mapping[str, str]) -> bool:
    """Run processes one after the other up to the first failure, and return whether all of them succeeded."""
    everything = {**os.environ, **WIDE, **KEPT, **environment}
    return all(
        subprocess.run(process, cwd=repository.ROOT, env=everything, check=False).returncode == 0
        for process in processes
    )


def main(cores: repository.Cores | None = None, simulator: Simulator | None = None) -> None:
    environment = {} if simulator is None else {"SIM": simulator}
    if cores:
        succeeded = all_succeed([pytest(tests_of(cores), workers_for(cores))], environment | settings(cores))
    else:
        succeeded = all_succeed([pytest()], environment)
        from commands.verify import sign_off  # its imports take as long as the tests of a small core

        print(sign_off.summary())
    if not succeeded:
        raise Mismatch("failed: see above")
