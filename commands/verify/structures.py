# SPDX-License-Identifier: Apache-2.0
"""Structures of a core: the `structures` mark of its own test is the only place that lists them.

A command imports no test. pytest runs the test with STRUCTURES set to a folder, and tests/conftest.py then writes the
arguments of `run_tb` there, and builds nothing.
"""

import json
import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from commands.common import repository
from tactile_depth import files

FOLDER = "STRUCTURES"  # environment variable
ARGUMENTS = "arguments.json"  # beside the ROM files of a structure


@dataclass(frozen=True)
class Structure:
    """One build of a core: the arguments that its test passes to `run_tb`."""

    toplevel: str
    parameters: Mapping[str, int | str]
    test_module: str
    roms: Callable[[Path], None] | None
    environment: Mapping[str, str]


@cache
def structures(core: str) -> tuple[Structure, ...]:
    """Return all structures of a core in the order of the groups both, verilator, icarus and regress of its mark.

    Raises RuntimeError: pytest failed.
    """
    test = repository.cores()[core].test
    assert test is not None, core
    with files.temporary() as folder:
        command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", f"--basetemp={folder}/tests", str(test)]
        environment = os.environ | {FOLDER: f"{folder}/structures", "SIM": "verilator"}
        ended = subprocess.run(
            command, cwd=repository.ROOT, env=environment, capture_output=True, text=True, check=False
        )
        if ended.returncode:
            raise RuntimeError(f"the structures of {core} cannot be read from {test}:\n{ended.stdout[-2000:]}")
        written = sorted((folder / "structures").iterdir(), key=lambda path: int(path.name))
        return tuple(_structure(path) for path in written)


def structure(core: str, index: int) -> Structure:
    """Return the structure of a core with this position in `structures`."""
    return structures(core)[index]


def _structure(folder: Path) -> Structure:
    """Read a structure from the folder that the fixture `run_tb` wrote."""
    arguments = json.loads((folder / ARGUMENTS).read_text())
    contents = {path.name: path.read_bytes() for path in folder.iterdir() if path.name != ARGUMENTS}

    def roms(place: Path) -> None:
        for name, content in contents.items():
            (place / name).write_bytes(content)

    return Structure(roms=roms if contents else None, **arguments)
