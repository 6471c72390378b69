# SPDX-License-Identifier: Apache-2.0
"""Builds tb/tb_<core>.py on each simulator. SIM=icarus or SIM=verilator narrows the run to one."""

import json
import os
import re
import shutil
import subprocess

import pytest

from commands import simulator as simulation

SEED = int(os.environ.get("SEED", "1"))
SIMULATORS = os.environ.get("SIM", ",".join(simulation.SIMULATORS)).split(",")


def pytest_configure(config):
    config.addinivalue_line(
        "markers",
        "structures(names, both=[..], icarus=[..]): the parameter sets of a test of RTL, as in parametrize; "
        "those under `icarus` are built there alone, in 0.1 s each, where Verilator takes 5 s; with HDL_COVERAGE=1, "
        "which only Verilator counts, there in place.",
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
    alone = "verilator" if simulation.COVERAGE else "icarus"
    cases += [(alone, *case) for case in icarus if alone in SIMULATORS]
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
        folder = simulation.BUILD / "tests" / f"{request.node.path.stem}-{name}"
        stamp = folder / "parameters.json"  # the runners rebuild for newer sources, not for other arguments
        names = [path.name for path in simulation.sources(sources)]
        structure = json.dumps([toplevel, names, parameters, simulation.COVERAGE and simulation.COVERAGE_ARGUMENTS])
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


@pytest.fixture
def refused(tmp_path):
    """What is said to parameters that `toplevel` must refuse: by its own check, which ends a simulation at time 0."""

    def run(toplevel, parameters):
        if "icarus" not in SIMULATORS:
            pytest.skip("SIM leaves Icarus out, which runs a module without a testbench")
        simulation.check("icarus")
        chosen = [f"-P{toplevel}.{name}={value}" for name, value in parameters.items()]
        model = tmp_path / "model.vvp"
        compiler = ["iverilog", "-g2012", "-s", toplevel, *chosen, "-o", model, *simulation.sources()]
        said = ""
        for command in (compiler, ["vvp", "-n", model]):
            result = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
            said += result.stdout + result.stderr
            if result.returncode:
                return said
        pytest.fail(f"{toplevel} took {parameters}:\n{said}")

    return run
