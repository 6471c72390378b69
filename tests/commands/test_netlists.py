# SPDX-License-Identifier: Apache-2.0
"""`make netlists` on two small cores: their netlists pass their testbenches, and a wrong netlist fails."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from commands.verify import mutate, netlists
from conftest import SEED
from tb.settings import RUN


@pytest.mark.parametrize(
    ("core", "dsps"), [("td_burst_counter", 0), pytest.param("twiddle", 4, marks=pytest.mark.regress)]
)
def test_a_netlist_is_as_the_rtl(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, core: str, dsps: Any) -> None:
    monkeypatch.setattr(netlists, "OUT", tmp_path)
    *_, case = netlists.cases([core])
    result = netlists.run(case, seed=1)
    assert result.tests > 0
    assert result.failed == 0
    assert result.cells.get("DSP48E1", 0) == dsps


def test_a_wrong_netlist_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(netlists, "OUT", tmp_path)
    synthesis = netlists.netlist

    def stuck(case: Any, folder: Path) -> Any:
        """Write a netlist in which every constant one is a zero."""
        cells = synthesis(case, folder)
        file = folder / "netlist.v"
        text = file.read_text()
        assert "1'h1" in text
        file.write_text(text.replace("1'h1", "1'h0"))
        return cells

    monkeypatch.setattr(netlists, "netlist", stuck)
    (case,) = netlists.cases(["td_burst_counter"])
    assert netlists.run(case, seed=1).failed > 0


@pytest.mark.netlist
@pytest.mark.parametrize("case", netlists.cases(RUN.cores or mutate.cores()), ids=lambda case: case.name)
def test_a_core_after_synthesis(case: netlists.Case, record_property: Callable[[str, object], None]) -> None:
    result = netlists.run(case, SEED)
    record_property("core", case.core)
    record_property("tests", result.tests)
    record_property("row", netlists.row(result))
    assert result.tests > 0
    assert result.failed == 0
