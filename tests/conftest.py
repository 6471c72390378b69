# SPDX-License-Identifier: Apache-2.0
"""Builds tb/tb_<core>.py on each simulator. SIM=icarus or SIM=verilator narrows the run to one."""

import json
import os
import re
import shutil

import pytest
from hypothesis import settings

from commands import simulator as simulation

SEED = int(os.environ.get("SEED", "1"))
SIMULATORS = os.environ.get("SIM", ",".join(simulation.SIMULATORS)).split(",")

settings.register_profile("no deadline", deadline=None)  # a busy machine is no failure of a model
settings.load_profile("no deadline")


def pytest_configure(config):
    config.addinivalue_line(
        "markers",
        "structures(names, both=[..], icarus=[..]): the parameter sets of a test of RTL, as in parametrize; "
        "those under `icarus` are built there alone, in 0.1 s each, where Verilator takes 5 s.",
    )


def pytest_generate_tests(metafunc):
    """Every test that takes a simulator runs on each, but for what its `structures` leave to Icarus."""
    if "simulator" not in metafunc.fixturenames:
        return
    mark = metafunc.definition.get_closest_marker("structures")
    if mark is None:
        metafunc.parametrize("simulator", SIMULATORS, indirect=True)
        return
    names, (both, icarus) = mark.args[0], (mark.kwargs["both"], mark.kwargs.get("icarus", []))
    cases = [(name, *case) for name in SIMULATORS for case in both]
    cases += [("icarus", *case) for case in icarus if "icarus" in SIMULATORS]
    ids = ["-".join(_label(value) for value in case) for case in cases]
    metafunc.parametrize(("simulator", *names.split()), cases, indirect=["simulator"], ids=ids)


def _label(value):
    return "-".join(f"{key}={choice}" for key, choice in value.items()) if isinstance(value, dict) else str(value)


@pytest.fixture
def simulator(request):
    return request.param


@pytest.fixture
def run_tb(simulator, request):
    """Build `toplevel` from `sources` (names in hdl/) and run its testbench.

    `roms`, called with the folder, writes the files that $readmemh reads there.
    """

    def run(toplevel, sources, parameters=None, test_module=None, roms=None, environment=None, files=()):
        name = re.sub(r"[^\w-]+", "_", request.node.name).strip("_")
        folder = simulation.ROOT / "build" / "tests" / f"{request.node.path.stem}-{name}"
        stamp = folder / "parameters.json"  # the runners rebuild for newer sources, not for other parameters
        structure = json.dumps([toplevel, [path.name for path in simulation.sources(sources)], parameters])
        if not stamp.is_file() or stamp.read_text() != structure:
            shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True, exist_ok=True)
        stamp.write_text(structure)
        if roms:
            roms(folder)
        log = folder / "run.log"
        simulation.build(
            simulator,
            toplevel,
            [*simulation.sources(sources), *files],
            parameters or {},
            folder,
            log=folder / "build.log",
        )
        count, failed = simulation.run(
            toplevel,
            test_module or f"tb_{toplevel}",
            folder,
            folder,
            simulator=simulator,
            seed=SEED,
            environment=environment,
            log=log,
        )
        if failed or not count:
            lines = [line for line in log.read_text().splitlines() if not line.startswith("make")]
            pytest.fail(f"{failed} of {count} tests failed in {log}\n" + "\n".join(lines[-40:]), pytrace=False)

    return run
