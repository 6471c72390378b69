# SPDX-License-Identifier: Apache-2.0
"""`python -m commands`: every command refuses unknown variables in one line, with exit status 2."""

import importlib
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from commands import __main__ as entry
from commands.__main__ import COMMANDS
from commands.common.repository import ROOT
from commands.hardware import asic
from commands.run import sim


def refusal(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *words: Any) -> Any:
    """Run a command that must end with status 2; returns the line that it prints."""
    monkeypatch.setattr("sys.argv", ["commands", *words])
    with pytest.raises(SystemExit) as ended:
        entry.main()
    output = capsys.readouterr()
    assert ended.value.code == 2
    assert output.out == ""
    lines = output.err.splitlines()
    assert len(lines) == 1, lines
    return lines[0]


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("word", ["NO_SUCH=1", "word"])
def test_every_command_refuses_what_it_does_not_know(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], command: Any, word: Any
) -> None:
    line = refusal(monkeypatch, capsys, command, word)
    assert line.startswith(f"make {command}: {word}: unknown variable: accepted ")


@pytest.mark.parametrize(("words", "name"), [((), "no command"), (("simulate", "N=16"), "simulate")])
def test_an_unknown_command_is_refused(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], words: Any, name: Any
) -> None:
    line = refusal(monkeypatch, capsys, *words)
    assert line == f"python -m commands: {name}: unknown command: accepted are {', '.join(sorted(COMMANDS))}"


REFUSED = {
    "mutate JOBS=0": "JOBS=0: accepted is a whole number from 1 to 1,000",
    "mutate MUTANTS=0": "MUTANTS=0: accepted is a whole number from 1 to 100,000",
    "mutate SECONDS=0": "SECONDS=0: accepted is a whole number from 1 to 86,400",
    "mutate SEED=-1": "SEED=-1: accepted is a whole number from 0 to 1e+09",
    "netlists SEED=nan": "SEED=nan: accepted is a whole number from 0 to 1e+09",
    "asic LIB=/nonexistent": "LIB=/nonexistent: no such file: give a Liberty file (.lib)",
    "asic CLOCK_MHZ=nan": "CLOCK_MHZ=nan: accepted is a number from 0.001 to 10,000",
    "asic NODE_NM=inf": "NODE_NM=inf: accepted is a number from 1 to 1,000",
    "tune MAX_DSP=inf": "MAX_DSP=inf: accepted is a number from 1e-09 to 1e+09",
    "tune TOLERANCE=nan": "TOLERANCE=nan: accepted is a number from 1e-09 to 1e+09",
    "reflex SPEED=nan": "SPEED=nan: accepted is a number from 5 to 200",
    "coverage TESTS=2": "TESTS=2: accepted is a whole number from 0 to 1",
    "regress JOBS=0": "JOBS=0: accepted is a whole number from 1 to 1,000",
    "calibrate PITCH=nan": "PITCH=nan: accepted is a number from 1e-06 to 1,000",
}


@pytest.mark.parametrize("words", REFUSED)
def test_a_value_that_is_not_accepted_is_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], words: Any
) -> None:
    command = words.split()[0]
    assert refusal(monkeypatch, capsys, *words.split()) == f"make {command}: {REFUSED[words]}"


def require_library() -> None:
    """Skip a test of `make asic` without its default library."""
    if not asic.DEFAULT_LIB.exists():
        pytest.skip(f"{asic.DEFAULT_LIB} is not installed: apt-get install qflow-tech-osu018")


LANES = {
    "LANES=2 SOLVER=spectral": "LANES=2 with SOLVER=spectral: it puts out one depth value per clock: set LANES=1, or "
    "SOLVER=tridiagonal",
    "LANES=64 SOLVER=tridiagonal": "LANES=64 with N=128: accepted are 1 to 32",
    "LANES=6 SOLVER=tridiagonal": "LANES=6 is not a power of two: try LANES=4 or LANES=8",
    "LANES=0 SOLVER=tridiagonal": "LANES=0 with N=128: accepted are 1 to 32",
    "LANES=many": "LANES=many: accepted is a whole number",
}


@pytest.mark.parametrize("words", LANES)
@pytest.mark.parametrize(
    "command", ["asic", "certify", "fpga TARGET=ulx3s", "sim", "synth TARGET=xczu7ev", "tune", "wrap NAME=finger"]
)
def test_lanes_that_cannot_be_built_are_refused(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], command: str, words: str
) -> None:
    if command == "asic":
        require_library()
    line = refusal(monkeypatch, capsys, *command.split(), *words.split())
    assert line == f"make {command.split()[0]}: {LANES[words]}"


@pytest.mark.parametrize("command", ["asic", "baselines", "certify", "extremes", "reflex", "report", "sweep", "synth"])
def test_an_out_that_is_too_long_is_refused(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path, command: Any
) -> None:
    module = importlib.import_module(f"commands.{entry.COMMANDS[command]}.{command}")
    if command == "asic":
        monkeypatch.setattr(module, "TOOLS", {})
        require_library()
    line = refusal(monkeypatch, capsys, command, f"OUT={tmp_path / ('x' * 300)}")
    assert "cannot be written (File name too long): give a folder that can" in line
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("status", "change"), [(0, 0), (1, 1)])
def test_a_command_returns_its_own_status(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path, status: Any, change: Any
) -> None:
    model = sim.tactile_depth
    monkeypatch.setattr(sim, "tactile_depth", lambda *words, **named: model(*words, **named) + change)
    monkeypatch.setattr("sys.argv", ["commands", "sim", "N=16", "SIM=icarus", f"OUT={tmp_path / 'out'}"])
    with pytest.raises(SystemExit) as ended:
        entry.main()
    assert ended.value.code == status


def test_a_path_that_is_no_text_is_printed_all_the_same(tmp_path: Path) -> None:
    out = os.fsencode(tmp_path) + b"/\xff"
    result = subprocess.run(
        [sys.executable, "-m", "commands", "sim", "N=16", "SIM=icarus", b"OUT=" + out],
        cwd=ROOT,
        capture_output=True,
        check=False,
    )
    assert result.returncode == 0, result.stderr
    assert b"\\udcff" in result.stdout


def test_a_reader_of_the_output_that_ends_is_no_traceback(tmp_path: Path) -> None:
    command = f"{sys.executable} -m commands sim N=16 SIM=icarus OUT={tmp_path / 'out'}"
    result = subprocess.run(
        ["bash", "-c", f"{command} | true; exit ${{PIPESTATUS[0]}}"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )
    assert result.returncode == 3
    assert result.stderr == "make sim: whatever reads the output has ended\n"
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["depth.npy", "depth.png", "report.json"]
