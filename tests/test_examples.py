# SPDX-License-Identifier: Apache-2.0
"""The notebook of real presses gives the committed outputs; other examples have tests beside those of their tools."""

import json
from typing import Any

import matplotlib
import pytest

from commands.common.repository import ROOT
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
