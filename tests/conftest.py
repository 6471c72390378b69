# SPDX-License-Identifier: Apache-2.0
"""Fixtures that build and run a testbench on each simulator; SIM=icarus or SIM=verilator selects one."""

import itertools
import json
import os
import re
import shutil
import time
import zlib
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from hypothesis import settings

from commands.common import repository
from commands.common import simulator as simulation
from commands.verify import structures
from tb.stream import CLOCK_NS, REGRESS
from tests.records import record

SEED = int(os.environ.get("SEED", "1"))
POWER_UPS = int(os.environ.get("POWER_UPS", "2"))  # random states to begin from
STATES_OF_A_BOARD = 8
QUICK_CLOCKS = 1000
SIMULATORS = os.environ.get("SIM", ",".join(simulation.SIMULATORS)).split(",")
NOTED = os.environ.get(structures.FOLDER)  # `run_tb` writes its arguments there and builds nothing

settings.register_profile("no deadline", deadline=None)  # a test of a model must not fail on a busy machine
settings.load_profile("no deadline")


def pytest_configure(config: Any) -> None:
    config.addinivalue_line(
        "markers",
        "structures(names, both=[..], verilator=[..], icarus=[..], regress=[..], regress_verilator=[..]): parameter "
        "sets of an RTL test, as in parametrize. Those of `both` run on both simulators, those of `verilator` and of "
        "`icarus` on one. Icarus builds in 0.1 s what takes Verilator 5 s. Those of `regress` run on Icarus and those "
        "of `regress_verilator` on Verilator, in `make regress` only. With HDL_COVERAGE=1 all run on Verilator, "
        "because only Verilator counts coverage.",
    )
    for name in simulation.SIMULATORS:
        config.addinivalue_line("markers", f"{name}: runs in this simulator; set for each test of RTL")
    config.addinivalue_line(
        "markers", "seeds: `make regress` runs it with another seed too, like every RTL test on Icarus"
    )


def pytest_generate_tests(metafunc: Any) -> None:
    """Run every test that takes a simulator on each simulator, except for the limits of its `structures` mark."""
    parametrized = [mark.args[0] for mark in metafunc.definition.iter_markers("parametrize")]
    if "simulator" not in metafunc.fixturenames or "simulator" in parametrized:
        return
    mark = metafunc.definition.get_closest_marker("structures")
    if mark is None:
        metafunc.parametrize("simulator", SIMULATORS, indirect=True)
        return
    chosen = chosen_structures(mark.kwargs)
    cases = [
        pytest.param(simulator, *case, id="-".join(map(_label, (simulator, *case))), marks=marks)
        for simulator in SIMULATORS
        for case, marks in chosen[simulator]
    ]
    metafunc.parametrize(("simulator", *mark.args[0].split()), cases, indirect=["simulator"])


def chosen_structures(groups: Any) -> dict[Any, Any]:
    """Return the structures of a mark by simulator, each with its marks."""
    both, verilator, icarus = (groups.get(name, []) for name in ("both", "verilator", "icarus"))
    regress, regress_verilator = (groups.get(name, []) for name in ("regress", "regress_verilator"))
    every = [*both, *verilator, *icarus, *regress]
    if NOTED:
        return {"verilator": [(case, ()) for case in every]}
    if simulation.COVERAGE:
        once = [case for index, case in enumerate(every) if case not in every[:index]]
        return {"verilator": [(case, ()) for case in once], "icarus": []}
    late = pytest.mark.regress
    return {
        "verilator": [(case, ()) for case in (*both, *verilator)] + [(case, late) for case in regress_verilator],
        "icarus": [(case, ()) for case in (*both, *icarus)] + [(case, late) for case in regress],
    }


def begins_at_random(item: Any) -> Any:
    """Return whether a test also runs from several random power-up states; see `run_tb`."""
    callspec = getattr(item, "callspec", None)
    first = callspec is not None and all(index == 0 for index in callspec.indices.values())
    device = item.originalname != "test_a_second_client"  # `test_rtl` runs that device from random states
    return first and device and "run_tb" in item.fixturenames and item.get_closest_marker("verilator") is not None


def pytest_collection_modifyitems(config: Any, items: Any) -> None:
    """Leave out what only `make regress` runs; where structures are noted, keep the test that states them."""
    for item in items:
        if "simulator" in getattr(item, "fixturenames", ()):
            item.add_marker(item.callspec.params["simulator"])
        if "run_tb" in getattr(item, "fixturenames", ()) and item.get_closest_marker("icarus"):
            item.add_marker("seeds")
    only_power_ups = os.environ.get("ONLY") == "power_ups"
    if NOTED:
        own = next(item.originalname for item in items if "run_tb" in item.fixturenames)  # other tests come after it
        config.hook.pytest_deselected(items=[item for item in items if item.originalname != own])
        items[:] = [item for item in items if item.originalname == own]
        return
    chosen: list[Any] = []
    others: list[Any] = []
    for item in items:
        in_regress_only = item.get_closest_marker("regress") and not REGRESS
        other_part = only_power_ups and not begins_at_random(item)
        (others if in_regress_only or other_part else chosen).append(item)
    config.hook.pytest_deselected(items=others)
    items[:] = chosen


def _label(value: Any) -> Any:
    return "-".join(f"{key}={choice}" for key, choice in value.items()) if isinstance(value, dict) else str(value)


@pytest.fixture
def simulator(request: pytest.FixtureRequest) -> Any:
    return request.param


def shortest(results: Any, clocks: int) -> str:
    """Return a filter for the tests with the least simulated time, up to `clocks` cycles in all; at least one test."""
    cases = []
    for case in ElementTree.parse(results).getroot().iter("testcase"):
        properties = {entry.get("name"): entry.get("value") for entry in case.iter("property")}
        cases.append((float(properties["sim_time_duration"]) / CLOCK_NS, case.get("name")))  # type: ignore[arg-type]
    cases.sort()
    total = itertools.accumulate(duration for duration, _ in cases)
    chosen = [
        name for index, (so_far, (_, name)) in enumerate(zip(total, cases, strict=True)) if so_far < clocks or not index
    ]
    return f"({'|'.join(map(re.escape, chosen))})$"  # type: ignore[arg-type]


def first_failure(run_folder: Any, failed: Any, count: int, log: Path) -> Any:
    """Return the message and the traceback of the first test that failed in a run, and where its log is."""
    summary = f"{failed} of {count} tests failed: {log}"
    for case in ElementTree.parse(run_folder / "results.xml").getroot().iter("testcase"):
        failure = case.find("failure")
        if failure is not None:
            return f"{failure.get('message')}\n  in {case.get('name')}; {summary}\n{failure.text}"
    return summary


def note(
    toplevel: str,
    parameters: Any = None,
    test_module: str | None = None,
    roms: Any = None,
    environment: Any = None,
    files: Any = (),
) -> None:
    """Stand in for `run_tb` where structures are noted: write the arguments and the ROM files of the next structure."""
    assert NOTED is not None
    assert not files, f"{toplevel}: a bench of SystemVerilog is no structure of a core"
    Path(NOTED).mkdir(exist_ok=True)
    folder = Path(NOTED) / str(len(list(Path(NOTED).iterdir())))
    folder.mkdir()
    if roms:
        roms(folder)
    arguments = {
        "toplevel": toplevel,
        "parameters": parameters or {},
        "test_module": test_module or repository.testbench(toplevel),
        "environment": environment or {},
    }
    (folder / structures.ARGUMENTS).write_text(json.dumps(arguments))


@pytest.fixture
def run_tb(simulator: str, request: pytest.FixtureRequest) -> Any:
    """Build `toplevel`, a core of hdl/ or a module in `files`, and run its testbench.

    A file of `files` replaces a core of the same name.
    `roms`, called with the folder, writes the files that $readmemh reads there. The first structure of a core with a
    reset is also run from several random power-up states, on Verilator, with the shortest of its tests.
    """

    def run(
        toplevel: Any,
        parameters: Any = None,
        test_module: Any = None,
        roms: Any = None,
        environment: Any = None,
        files: Any = (),
    ) -> None:
        name = re.sub(r"[^\w-]+", "_", request.node.name).strip("_")
        folder = simulation.BUILD / "tests" / f"{request.node.path.stem}-{name}"
        stamp = folder / "parameters.json"  # the runners rebuild for newer sources, not for other parameters
        flags = zlib.crc32(Path(simulation.__file__).read_bytes())
        cores = repository.sources(toplevel if toplevel in repository.cores() else None)
        sources = list({path.name: path for path in [*cores, *files]}.values())
        structure = json.dumps([toplevel, list(map(str, sources)), parameters, flags])
        if not stamp.is_file() or stamp.read_text() != structure:
            shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True, exist_ok=True)
        stamp.write_text(structure)
        if roms:
            roms(folder)
        simulation.build(
            simulator,
            toplevel,
            sources,
            parameters or {},
            folder,
            log=folder / "build.log",
        )

        def play(log: Path, environment: Any, **arguments: Any) -> None:
            count, failed = simulation.run(
                toplevel,
                test_module or repository.testbench(toplevel),
                folder,
                folder,
                simulator=simulator,
                seed=SEED,
                environment=environment,
                log=log,
                **arguments,
            )
            if failed or not count:
                pytest.fail(first_failure(run_folder=folder, failed=failed, count=count, log=log), pytrace=False)

        began = time.monotonic()
        play(folder / "run.log", environment)
        top = next(path for path in [*sources, *files] if path.stem == toplevel)
        if not begins_at_random(request.node) or "rst" not in top.read_text():
            return
        quick = {**(environment or {}), "COCOTB_TEST_FILTER": shortest(folder / "results.xml", QUICK_CLOCKS)}
        states = POWER_UPS if toplevel in repository.cores() else min(POWER_UPS, STATES_OF_A_BOARD)
        for power_up in range(1, states):  # the run above was the first
            play(folder / "power_up.log", quick, power_up=SEED * 1000 + power_up)
        record(
            part="power-up states", what=toplevel, simulator=simulator, runs=states, seconds=time.monotonic() - began
        )

    return note if NOTED else run
