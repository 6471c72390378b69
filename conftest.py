# SPDX-License-Identifier: Apache-2.0
"""Tests of RTL: testbenches of tb/ on their STRUCTURES. SIM=icarus or SIM=verilator selects one, SEED a seed."""

import os

os.environ["OPENBLAS_NUM_THREADS"] = "1"  # here and in each process of a test: workers of pytest fill the cores
os.environ["PYTHONDONTWRITEBYTECODE"] = ""  # a thousand processes import the same modules

import itertools
import re
import shutil
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from hypothesis import settings

from commands.common import repository
from commands.common import simulator as simulation
from tb.settings import RUN
from tb.stream import CLOCK_NS
from tb.structures import Structure

SEED = int(os.environ.get("SEED", "1"))
STATES_OF_A_BOARD = 8
QUICK_CLOCKS = 1000
BENCHES = {core.benches[0] for core in repository.cores().values() if len(core.benches) == 1}
SIMULATORS = os.environ.get("SIM", ",".join(simulation.SIMULATORS)).split(",")
# A test of a model must not fail on a busy machine; `make regress` tries more.
settings.register_profile("tests", deadline=None, max_examples=100 if RUN.full else 25)
settings.load_profile("tests")


def test_rtl(run_tb: Callable[..., None], structure: Structure) -> None:
    run_tb(structure)


class CoreBench(pytest.Module):
    """Testbench of a core, which cocotb plays: to pytest it has one test, on each of its STRUCTURES."""

    def collect(self) -> Iterable[pytest.Item | pytest.Collector]:
        self.obj.test_rtl = test_rtl
        return super().collect()


def pytest_pycollect_makemodule(module_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    return CoreBench.from_parent(parent, path=module_path) if module_path in BENCHES else None


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    named = parent.session.isinitpath(file_path)  # on the command line: then pytest makes its module
    return None if named else pytest_pycollect_makemodule(file_path, parent)


def core_of(path: Path) -> str:
    """Return the core that the file of a test tests."""
    return path.stem.removeprefix("test_").removeprefix("tb_")


def pytest_generate_tests(metafunc: Any) -> None:
    """Run every test that takes a simulator on each simulator, and its structures where each says."""
    parametrized = [mark.args[0] for mark in metafunc.definition.iter_markers("parametrize")]
    if "simulator" not in metafunc.fixturenames or "simulator" in parametrized:
        return
    if "structure" not in metafunc.fixturenames:
        metafunc.parametrize("simulator", SIMULATORS, indirect=True)
        return
    mark = metafunc.definition.get_closest_marker("structures")
    structures = mark.args[0] if mark else metafunc.module.STRUCTURES
    core = core_of(metafunc.definition.path)
    inside = core in repository.cores() and core not in ("tactile_depth", *repository.outermost())
    cases = [
        pytest.param(simulator, structure, id=f"{simulator}-{structure.label}", marks=marks)
        for simulator in SIMULATORS
        for structure, marks in chosen_structures(simulator, structures, inside)
    ]
    metafunc.parametrize(("simulator", "structure"), cases, indirect=["simulator"])


def chosen_structures(simulator: str, structures: Sequence[Structure], inside: bool) -> list[tuple[Structure, Any]]:
    """Return the structures that run on a simulator, each with its marks.

    The whole suite plays the first structure of a small core, and on Verilator, which builds it longer than it plays
    it, a core that is `inside` another only there. `make test CORE=` and `make regress` play all.
    """
    first = [structure for structure in structures if simulator in structure.on]
    late = [structure for structure in structures if simulator not in structure.on]
    if not RUN.cores:
        other = inside and simulator == "verilator" and "icarus" in SIMULATORS
        elsewhere = first if other else [structure for structure in first[1:] if not structure.device]
        late = [*elsewhere, *late]
        first = [structure for structure in first if structure not in late]
    return [*((structure, ()) for structure in first), *((structure, pytest.mark.regress) for structure in late)]


def begins_at_random(item: Any) -> bool:
    """Return whether a test also runs from several random power-up states; see `run_tb`."""
    callspec = getattr(item, "callspec", None)
    if callspec is None or "structure" not in callspec.params or any(callspec.indices.values()):
        return False
    device = item.originalname != "test_a_second_client"  # `test_rtl` runs that device from random states
    return device and "run_tb" in item.fixturenames and item.get_closest_marker("verilator") is not None


def pytest_collection_modifyitems(items: Any) -> None:
    """Mark the tests of RTL, before `-m` selects by mark; put the long ones first."""
    for item in items:
        if "simulator" in getattr(item, "fixturenames", ()):
            item.add_marker(item.callspec.params["simulator"])
        if "run_tb" in getattr(item, "fixturenames", ()):
            item.add_marker("seeds")
        if begins_at_random(item):
            item.add_marker("power_ups")
    items.sort(key=lambda item: item.get_closest_marker("long") is None)


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


@pytest.fixture
def run_tb(simulator: str, request: pytest.FixtureRequest) -> Any:
    """Build a structure of a core of hdl/, or of a module in `files`, and run its testbench.

    The top level has the name of the test's file by default. A file of `files` replaces a core of the same name. In
    `make regress` the first structure of a core with a reset is also run from many random power-up states, on
    Verilator, with the shortest of its tests.
    """

    def run(
        structure: Structure, *, toplevel: str = "", test_module: str = "", files: Any = (), **settings: Any
    ) -> None:
        toplevel = toplevel or core_of(request.path)
        name = re.sub(r"[^\w-]+", "_", request.node.name).strip("_")
        folder = simulation.BUILD / "tests" / f"{request.node.path.stem}-{name}"
        cores = repository.sources(toplevel if toplevel in repository.cores() else None)
        sources = list({path.name: path for path in [*cores, *files]}.values())
        state, built = simulation.state([simulator, toplevel, structure.parameters], sources), folder / "built"
        if not built.is_file() or built.read_text() != state:
            shutil.rmtree(folder, ignore_errors=True)
            simulation.build(simulator, toplevel, sources, structure.parameters, folder, log=folder / "build.log")
            built.write_text(state)
        if structure.roms:
            structure.roms(folder)
        full = RUN.full and simulator == "verilator"  # Icarus takes up to ten times as long
        wanted = replace(RUN, device=structure.device, level=structure.level, full=full)
        environment = replace(wanted, **settings).environment
        bench = test_module or repository.testbench(toplevel)
        if not test_module and "," in bench:  # of several files: no test of them depends on an earlier one
            environment["COCOTB_RANDOM_TEST_ORDER"] = "1"

        def play(log: Path, **arguments: Any) -> None:
            count, failed = simulation.run(
                toplevel,
                bench,
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
        play(folder / "run.log")
        top = next(path for path in [*sources, *files] if path.stem == toplevel)
        if not begins_at_random(request.node) or "rst" not in top.read_text():
            return
        environment["COCOTB_TEST_FILTER"] = shortest(folder / "results.xml", QUICK_CLOCKS)
        states = RUN.power_ups if toplevel in repository.cores() else min(RUN.power_ups, STATES_OF_A_BOARD)
        for power_up in range(1, states):  # the run above was the first
            play(folder / "power_up.log", power_up=SEED * 1000 + power_up)
        seconds = time.monotonic() - began
        record = {"part": "power-up states", "what": toplevel, "simulator": simulator, "runs": states}
        request.node.user_properties.append(("records", [record | {"seconds": seconds}]))

    return run
