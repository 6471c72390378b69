# SPDX-License-Identifier: Apache-2.0
"""`make quick`: tests and lint of what differs from BASE, and one run of the whole, in under two minutes.

BASE is a commit, by default the merge base with origin/main. Uncommitted changes and untracked files count. The command
names changed files that many tests depend on: run `make test` for these.
"""

import os
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from commands.common import repository
from commands.common.repository import ROOT, git
from commands.common.variables import Mismatch, Name
from commands.verify.test import all_succeed, pytest, settings, tests_of
from tactile_depth.base.errors import InputError

UPSTREAM = "origin/main"
WHOLE = ("sim", "N=64", "SOLVER=tridiagonal")
PAGES = "tests/test_docs.py"


@dataclass(frozen=True)
class Affected:
    """Cores and test files that changed files belong to, and the changed files that belong to none."""

    cores: list[str]
    tests: list[str]
    shared: list[str]


def base_commit(base: str) -> str:
    """Return the commit to compare with. Raises InputError: there is no such commit, or no BASE and no origin/main."""
    if not base:
        found = git("merge-base", UPSTREAM, "HEAD")
        mend = f"there is no {UPSTREAM} to compare with: give BASE=<commit>"
    else:
        found = git("rev-parse", "--verify", "--quiet", "--end-of-options", f"{base}^{{commit}}")
        mend = f"BASE={base}: no such commit: give a commit, a branch or a tag"
    if found is None:
        raise InputError(mend)
    return found.decode().strip()


def changed_files(commit: str) -> list[str]:
    """Return the files that differ from a commit, untracked files included. Raises InputError: git failed."""
    tracked = git("diff", "--name-only", "-z", commit)
    untracked = git("ls-files", "--others", "--exclude-standard", "-z")
    if tracked is None or untracked is None:
        raise InputError(f"git does not list what differs from {commit}: run `git status`")
    return sorted({os.fsdecode(name) for name in (tracked + untracked).split(b"\0") if name})


def affected(names: Iterable[str]) -> Affected:
    """Find the cores and the test files of changed files."""
    owner = {
        str(file.relative_to(ROOT)): core.name
        for core in repository.cores().values()
        for file in (
            *(core.hdl, core.model, *core.benches, *core.bench_folder.glob("*.py"), core.proof),
            ROOT / "formal" / core.block / f"protocol_{core.name}.sv",
        )
        if file
    }
    cores, tests, shared = set(), set(), []
    for name in names:
        path = Path(name)
        if name in owner:
            cores.add(owner[name])
        elif test := test_of(path):
            tests.add(test)
        elif path.suffix in (".py", ".sv", ".vlt", ".toml", ".txt") or path.name == "Makefile":
            shared.append(name)
    return Affected(sorted(cores), sorted(tests - set(tests_of(sorted(cores)))), shared)


def test_of(path: Path) -> str | None:
    """Return the test file of a file that belongs to no core, if there is one."""
    if path.parts[0] == "tests" and path.name.startswith("test_"):
        candidate = path
    elif path.parts[0] == "commands":
        candidate = Path("tests", "commands", f"test_{path.stem}.py")
    elif path.parts[:2] == ("models", "tactile_depth"):
        candidate = Path("tests", f"test_{path.stem}.py")
    elif path.suffix == ".md":
        candidate = Path(PAGES)
    else:
        return None
    return str(candidate) if (ROOT / candidate).is_file() else None


def plan(changes: Affected) -> list[Sequence[str]]:
    """Return the processes to run, the fastest to fail first."""
    tests = [*(tests_of(changes.cores) if changes.cores else []), *changes.tests]
    return [
        *([pytest(tests)] if tests else []),
        [sys.executable, "-m", "commands", *WHOLE],
        [sys.executable, "-m", "ruff", "check", "--quiet", "."],
    ]


def main(base: Name = "") -> None:
    commit = base_commit(base)
    changes = affected(changed_files(commit))
    print(f"against {commit[:9]}: cores {', '.join(changes.cores) or 'none'}", flush=True)
    for test in changes.tests:
        print(f"  {test}")
    for name in changes.shared:
        print(f"  {name} is shared: make test runs what depends on it")
    sys.stdout.flush()
    if not all_succeed(plan(changes), settings(changes.cores)):
        raise Mismatch("failed: see above")
