# SPDX-License-Identifier: Apache-2.0
"""Structures of a core, read from its own test: the `structures` mark is the only place that lists them.

The test function runs with a stand-in for `run_tb` that records its arguments and starts no simulator.
"""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from commands.common import repository

GROUPS = ("both", "verilator", "icarus", "regress")  # of the mark `structures`, see tests/conftest.py


@dataclass(frozen=True)
class Structure:
    """One build of a core: the arguments that its test passes to `run_tb`."""

    toplevel: str
    parameters: Mapping[str, int | str]
    test_module: str
    roms: Callable[[Path], None] | None
    environment: Mapping[str, str]


def structure(core: str, index: int) -> Structure:
    """Return the structure of a core with this position in the groups of its `structures` mark, GROUPS in order."""
    file = repository.cores()[core].test
    assert file is not None, core
    module = importlib.import_module(repository.module(file))
    tests = [
        function
        for name, function in vars(module).items()
        if name.startswith("test_")
        and inspect.isfunction(function)
        and "run_tb" in inspect.signature(function).parameters
    ]
    test = tests[0]  # the core's own; others run it in another way
    chosen = {"simulator": "verilator"} if "simulator" in inspect.signature(test).parameters else {}
    kept: list[Structure] = []

    def keep(
        toplevel: str,
        parameters: Mapping[str, int | str] | None = None,
        test_module: str | None = None,
        roms: Callable[[Path], None] | None = None,
        environment: Mapping[str, str] | None = None,
        files: Sequence[Path] = (),
    ) -> None:
        assert not files, f"{core}: a bench of SystemVerilog"
        bench = test_module or repository.testbench(toplevel)
        kept.append(Structure(toplevel, parameters or {}, bench, roms, environment or {}))

    cases: list[tuple[Any, ...]] = [()]
    names: list[str] = []
    for mark in getattr(test, "pytestmark", []):
        if mark.name == "structures":
            names = mark.args[0].split()
            cases = [case for group in GROUPS for case in mark.kwargs.get(group, [])]
        elif mark.name == "parametrize":
            names = [mark.args[0]] if isinstance(mark.args[0], str) else list(mark.args[0])
            cases = [case if len(names) > 1 else (case,) for case in mark.args[1]]
    test(keep, **chosen, **dict(zip(names, cases[index], strict=True)))
    return kept[0]
