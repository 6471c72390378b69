# SPDX-License-Identifier: Apache-2.0
"""`make nexus`: what it changes in Yosys' netlist, what it reads from nextpnr, and refusals."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from commands.common import repository
from commands.hardware import fpga, nexus
from tactile_depth.base.errors import InputError

FULL = "Info: \t MULT18_CORE:     64/     56   114%\n"


def test_carries_tied_to_0_are_left_open() -> None:
    cells: dict[str, Any] = {
        "low": {"type": "VLO", "connections": {"Z": [5]}},
        "first": {"type": "CCU2", "connections": {"CIN": [5], "A0": [5]}},
        "second": {"type": "CCU2", "connections": {"CIN": [6], "A0": [5]}},
    }
    nexus.without_low_carries({"modules": {nexus.TOP: {"cells": cells}}})
    assert cells["first"]["connections"] == {"A0": [5]}
    assert cells["second"]["connections"] == {"CIN": [6], "A0": [5]}


def router(monkeypatch: pytest.MonkeyPatch, problem: str, log: str = "") -> None:
    """Put in place of nextpnr what leaves a report and a log, and returns an error."""

    def tool(_name: str, _options: Any, folder: Path, output: str, _seconds: int) -> str:
        seed = output.partition(".")[0]
        (folder / f"{seed}.log").write_text(log)
        (folder / f"{seed}.json").write_text('{"fmax": {}}')
        return problem

    monkeypatch.setattr(fpga, "tool", tool)


def test_what_nextpnr_says_is_reported(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    router(monkeypatch, "")
    assert nexus.route(1, 30, tmp_path) == json.loads((tmp_path / "1.json").read_text())
    router(monkeypatch, "ERROR: no bels", FULL)
    with pytest.raises(InputError, match="does not fit the LIFCL-40-9BG400C: MULT18_CORE: 64 of 56, 8 too many"):
        nexus.route(1, 30, tmp_path)
    router(monkeypatch, "ERROR: no route")
    with pytest.raises(RuntimeError, match="seed 1: ERROR: no route"):
        nexus.route(1, 30, tmp_path)


def test_a_seed_that_takes_too_long_says_what_to_give(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def endless(*_words: Any) -> str:
        raise fpga.TimeUsedUp

    monkeypatch.setattr(fpga, "tool", endless)
    with pytest.raises(RuntimeError, match="seed 2 took 30 minutes of a processor: give MINUTES=60"):
        nexus.route(2, 30, tmp_path)


def test_every_pin_has_a_place_of_its_own() -> None:
    (source,) = repository.BOARDS["nexus"]
    pins = re.findall(r"^  (?:in|out)put +wire (\w+)", source.read_text(), re.MULTILINE)
    sites = dict(re.findall(r"\{(\w+)\} \[get_ports (\w+)\]", nexus.CONSTRAINTS.read_text()))
    assert sorted(sites.values()) == sorted(pins)


@pytest.mark.parametrize("word", ["SEEDS=0", "MINUTES=x", "LANES=3", "TARGET=nexus"])
def test_bad_input_is_refused(refused: Any, word: str) -> None:
    assert word.partition("=")[0] in refused("nexus", word)
