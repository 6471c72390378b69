# SPDX-License-Identifier: Apache-2.0
"""Examples: every one runs, and the notebook of real presses gives the committed outputs."""

import json
import subprocess
import sys
from typing import Any

import matplotlib
import pytest

from commands.common.repository import ROOT
from commands.common.simulator import SIMULATORS, check
from tests.real_data import FOLDER, needs_real_data

NOTEBOOK = ROOT / "examples" / "real_presses.ipynb"


@needs_real_data
def test_the_notebook_of_real_presses(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(ROOT)
    monkeypatch.setenv("TACTILE_DATA", str(FOLDER))
    matplotlib.use("Agg")
    scope: dict[Any, Any] = {}
    for cell in json.loads(NOTEBOOK.read_text())["cells"]:
        if cell["cell_type"] != "code":
            continue
        exec("".join(cell["source"]), scope)
        printed = "".join("".join(out["text"]) for out in cell["outputs"] if out["output_type"] == "stream")
        assert capsys.readouterr().out == printed


@pytest.mark.parametrize("simulator", SIMULATORS)
def test_the_testbench_of_a_depth_map(simulator: str) -> None:
    check(simulator)
    command = [sys.executable, str(ROOT / "examples" / "cocotb" / "run.py"), simulator]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout + result.stderr
    assert "1 of 1 tests passed" in result.stdout
