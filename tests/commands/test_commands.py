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
from commands.hardware import asic, yosys
from tactile_depth.base.files import RECORD


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("word", ["NO_SUCH=1", "word"])
def test_every_command_refuses_what_it_does_not_know(refused: Any, command: Any, word: Any) -> None:
    line = refused(command, word)
    assert line.startswith(f"make {command}: {word}: unknown variable: accepted ")


@pytest.mark.parametrize(
    ("words", "name"), [((), "no command"), (("simulate", "N=16"), "simulate"), (("coverage",), "coverage")]
)
def test_an_unknown_command_is_refused(refused: Any, words: Any, name: Any) -> None:
    line = refused(*words)
    assert line == f"python -m commands: {name}: unknown command: accepted are {', '.join(sorted(COMMANDS))}"


UNTUNABLE = """
    CLOCK_MHZ=0 FRAMES=cube FRAMES=flat LANES=3 LANES=16 MAX_DSP=0 MAX_LATENCY_US=nan MAX_MAP_LATENCY_US=0 N=100 N=2048
    SOLVER=multigrid TOLERANCE=-1 TOLERANCE=0 TOLERANCE=little"""
BOARD = "fpga TARGET=ulx3s"
REFUSED = {
    "asic CLOCK_MHZ=nan": "CLOCK_MHZ=nan: accepted is a number from 0.001 to 10,000",
    "asic LIB=none.lib NODE_NM=90": "LIB=none.lib: no such file: give a Liberty file (.lib)",
    "asic NODE_NM=inf": "NODE_NM=inf: accepted is a number from 1 to 1,000",
    "baselines CLOCK_MHZ=nan": "CLOCK_MHZ=nan: accepted is a number from",
    "baselines GRIDS=,": "GRIDS=,: accepted are powers of two from 16 to 512",
    "baselines GRIDS=1024": "GRIDS=1024: accepted are powers of two from 16 to 512",
    "baselines GRIDS=64,100": "GRIDS=64,100: accepted are powers of two from 16 to 512",
    "baselines RUNS=1": "RUNS=1: accepted is a whole number from 10",
    "calibrate BITS=7": "BITS=7: accepted is a whole number from 1 to 6",
    "calibrate BITS=x": "BITS=x",
    "calibrate CIRCLES=drawn": "CIRCLES=drawn is unknown: accepted are table, found",
    "calibrate EXPOSURE_US=0": "EXPOSURE_US=0: accepted is a number",
    "calibrate GRADIENT=both": "GRADIENT=both is unknown: accepted are all, lut, quadratic, cubic",
    "calibrate HELD_OUT=all": "HELD_OUT=all: unknown variable",
    "calibrate OUT=x.txt": "OUT=x.txt: give the name of an .npz file",
    "calibrate PITCH=0": "PITCH=0",
    "calibrate PITCH=nan": "PITCH=nan: accepted is a number from 1e-06 to 1,000",
    "certify DEPTH_RANGE=deep": "DEPTH_RANGE=deep",
    "certify N=100": "N=100",
    "certify RTL=2": "RTL=2",
    "extremes N=100": "N=100",
    "extremes PRESET=other": "PRESET=other is unknown",
    "extremes PRESET=sensor ROWS=64": "ROWS=64 and COLS=64: 64 x 64 pixels (columns x rows), but gelsight-mini",
    "extremes PRESET=sensor SHORT=1": "SHORT=1: unknown variable",
    "extremes RTL=0": "RTL=0: unknown variable",
    "extremes SHORT=2": "SHORT=2",
    "extremes SIM=other": "SIM=other",
    "fpga": "TARGET= is unknown: accepted are ulx3s, nexus",
    "fpga TARGET=ulx4m": "TARGET=ulx4m is unknown: accepted are ulx3s, nexus",
    f"{BOARD} CALIBRATION=none.npz": "none.npz",
    f"{BOARD} CAMERA=raw8 SENSOR=ov2640": "SENSOR=ov2640 is unknown: accepted are ov7670, ov7725",
    f"{BOARD} CAMERA=raw8 SENSOR=ov5640": "SENSOR=ov5640 sends pictures of 1280 x 960 pixels",
    f"{BOARD} CAMERA=yuyv": "CAMERA=yuyv: the board sets cameras to raw8",
    f"{BOARD} CLOCK_MHZ=90": "CLOCK_MHZ=90: accepted are 25, 50, 75, 100, 150",
    f"{BOARD} GAIN_WIDTH=12 REFERENCE=flat": "GAIN_WIDTH=12 is out of range",
    f"{BOARD} N=100": "N=100",
    f"{BOARD} REFERENCE=none.png": "none.png",
    f"{BOARD} SEEDS=0": "SEEDS=0: accepted are different whole numbers from 1 with commas",
    f"{BOARD} SEEDS=1,x": "SEEDS=1,x: accepted are different whole numbers",
    f"{BOARD} SEEDS=2,2": "SEEDS=2,2",
    f"{BOARD} MINUTES=0": "MINUTES=0: accepted is a whole number from 1 to 1,440",
    f"{BOARD} SENSOR=ov7725": "SENSOR=ov7725 goes with CAMERA=raw8",
    "mutate JOBS=0": "JOBS=0: accepted is a whole number from 1 to 1,000",
    "mutate MUTANTS=0": "MUTANTS=0: accepted is a whole number from 1 to 100,000",
    "mutate SECONDS=0": "SECONDS=0: accepted is a whole number from 1 to 86,400",
    "mutate SEED=-1": "SEED=-1: accepted is a whole number from 0 to 1e+09",
    "netlists SEED=nan": "SEED=nan: accepted is a whole number from 0 to 1e+09",
    "reflex CLOCK_MHZ=1": "come faster: accepted is 6.554",
    "reflex HOST_TRIALS=2.5": "HOST_TRIALS=2.5: accepted is a whole number",
    "reflex N=100": "N=100 is not a power of two",
    "reflex N=1024": "16 to 512",
    "reflex SEED=-1": "SEED=-1: accepted is a whole number",
    "reflex SIM=vcs": "SIM=vcs is unknown",
    "reflex SPEED=fast": "SPEED=fast: accepted is a number from 5 to 200",
    "reflex SPEED=nan": "SPEED=nan: accepted is a number from 5 to 200",
    "reflex TRIALS=1": "TRIALS=1: accepted is a whole number from 2",
    "regress JOBS=0": "JOBS=0: accepted is a whole number from 1 to 1,000",
    "synth BAYER=grbg": "BAYER=grbg goes with CAMERA",
    "synth CAMERA=raw10 N=256": "is 1.34 pixels for each of the grid: 2 are needed",
    "synth GRIDS=64,7": "GRIDS=7: ",
    "synth GRIDS=64;128": "GRIDS=64;128: accepted are whole numbers",
    "synth N=1024 SOLVER=spectral": "1024",
    "synth TARGET=xc7a15t": "TARGET=xc7a15t is unknown: accepted are xczu7ev, ecp5, xc7a35t, xc7a100t, xc7z020",
    "tune TARGET=xc7a35t": "TARGET=xc7a35t is unknown: accepted are xczu7ev, ecp5",
    "trade FOLDS=3": "FOLDS=3: unknown variable",
    "trade PRESSES=nowhere": "nowhere: no presses.csv in it",
    "trade RTL=many": "RTL=many: accepted is a whole number from 0 to 1,000",
    **{f"tune N=16 SIM=icarus {word}": word.partition("=")[2] for word in UNTUNABLE.split()},
    "tune DATA_WIDTH=20": "DATA_WIDTH=20: unknown variable",
    "tune MAX_DSP=inf": "MAX_DSP=inf: accepted is a number from 1e-09 to 1e+09",
    "tune TARGET=ulx3s": "TARGET=ulx3s is unknown: accepted are xczu7ev, ecp5",
    "tune TOLERANCE=auto N=16": "TOLERANCE=auto: the error of synthetic was not measured: give a number",
    "tune TOLERANCE=nan": "TOLERANCE=nan: accepted is a number from 1e-09 to 1e+09",
}


@pytest.mark.parametrize("words", REFUSED)
def test_a_value_that_is_not_accepted_is_named(
    tmp_path: Path, refused: Any, monkeypatch: pytest.MonkeyPatch, words: str
) -> None:
    """Refuse bad input in one line, before a tool runs or anything is written."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(yosys, "run", None)
    name, *given = words.split()
    if name == "asic" and "LIB" not in words:
        require_library()
    line = refused(name, *given)
    assert line.startswith(f"make {name}: ")
    assert REFUSED[words] in line
    assert list(tmp_path.iterdir()) == []


def require_library() -> None:
    """Skip a test of `make asic` without its default library."""
    if not asic.DEFAULT_LIB.exists():
        pytest.skip(f"{asic.DEFAULT_LIB} is not installed: apt-get install qflow-tech-osu018")


LANES = {
    "LANES=2 SOLVER=spectral": "LANES=2 with SOLVER=spectral: it puts out one depth value per clock: set LANES=1, or "
    "SOLVER=tridiagonal",
    "LANES=128 SOLVER=tridiagonal": "LANES=128 with N=128: accepted are 1 to 64",
    "LANES=6 SOLVER=tridiagonal": "LANES=6 is not a power of two: try LANES=4 or LANES=8",
    "LANES=0 SOLVER=tridiagonal": "LANES=0 with N=128: accepted are 1 to 64",
    "LANES=many": "LANES=many: accepted is a whole number",
}


@pytest.mark.parametrize("words", LANES)
@pytest.mark.parametrize(
    "command", ["asic", "certify", "fpga TARGET=ulx3s", "sim", "synth TARGET=xczu7ev", "tune", "wrap NAME=finger"]
)
def test_lanes_that_cannot_be_built_are_refused(refused: Any, command: str, words: str) -> None:
    if command == "asic":
        require_library()
    line = refused(*command.split(), *words.split())
    assert line == f"make {command.split()[0]}: {LANES[words]}"


WITH_OUT = ("asic", "baselines", "certify", "extremes", "reflex", "report", "sweep", "synth", "trade", "tune")
BAD_OUT = {"x" * 300: "cannot be written (File name too long): give a folder that can", "file": "is a file"}


@pytest.mark.parametrize("command", WITH_OUT)
@pytest.mark.parametrize("out", BAD_OUT, ids=("too long", "a file"))
def test_an_out_that_cannot_be_used_is_refused(
    refused: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, command: str, out: str
) -> None:
    (tmp_path / "file").touch()
    module = importlib.import_module(f"commands.{entry.COMMANDS[command]}.{command}")
    if command == "asic":
        monkeypatch.setattr(module, "TOOLS", {})
        require_library()
    assert BAD_OUT[out] in refused(command, f"OUT={tmp_path / out}")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


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
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == [
        RECORD,
        "depth.npy",
        "depth.png",
        "report.json",
    ]
