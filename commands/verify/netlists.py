# SPDX-License-Identifier: Apache-2.0
"""`make netlists`: every core after synthesis in its testbench, and the top at 32 x 32 with each solver.

Takes CORE=name,.. and SEED=1. Yosys maps to 7-series logic, whose cells have simulation models in its library: LUT1 to
LUT6, CARRY4, FDRE, SRL16E, DSP48E1. Memories stay arrays, as in td_ram.sv and td_rom.sv, because a macro replaces them.
The testbench compares every output with the bit-accurate model, as it does for the RTL. Parameters are those at which
`make mutate` runs the core. pytest runs each netlist as an item of tests/commands/test_netlists.py. Exit status: 0 when
all agree, 1 when not, 2 on bad input.
"""

import json
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from commands.common import repository
from commands.common import simulator as simulation
from commands.common.variables import Seed
from commands.hardware import yosys
from commands.verify import items, mutants, mutate
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.limits import COLUMNS
from tactile_depth.chip.tactile_depth import hdl_parameters, write_roms
from tactile_depth.sensor.synthetic import synthetic_for
from tb.settings import RunSettings
from tb.structures import Structure

OUT = repository.ROOT / "build" / "netlists"
ITEMS = "tests/commands/test_netlists.py::test_a_core_after_synthesis"
LIBRARY = "share/xilinx/cells_sim.v"  # Yosys' simulation models of the cells
WHOLE = "tactile_depth"
WHOLE_SIZE = 32
# Last level of the testbench of the top, by simulator (tb/selection.py). Icarus sees X, but plays 500 cycles a minute.
WHOLE_LEVELS = {"icarus": "first", "verilator": "stream"}
LIBRARY_AS_IT_IS = "".join(
    f'lint_off {rule}-file "*{file}"\n'
    for file in ("cells_sim.v", "netlist.v")
    for rule in ("", "-rule UNOPTFLAT ", "-rule SPECIFYIGN ", "-rule COMBDLY ", "-rule INITIALDLY ")
)


@dataclass(frozen=True)
class Case:
    """Structure of a core, and the levels of its run."""

    core: str
    name: str
    structure: Structure
    levels: Mapping[str, str] = field(default_factory=lambda: {"icarus": "whole"})  # by simulator


@dataclass(frozen=True)
class Result:
    """Cells of a netlist, tests run and tests failed."""

    case: Case
    cells: Mapping[str, int]
    tests: int
    failed: int
    seconds: float


def cases(names: Sequence[str]) -> list[Case]:
    """Return the structures of `make mutate` for each core in `names`, and both solvers for the top."""
    listed = []
    for name in names:
        if name == WHOLE:
            listed += [whole_design(solver) for solver in COLUMNS]
            continue
        listed += [Case(name, f"{name}-{built.label}", built) for built in repository.structures(name)]
    return listed


def whole_design(solver: str) -> Case:
    choices: dict[str, Any] = {"columns": WHOLE_SIZE, "rows": WHOLE_SIZE, "solver": solver, "bits_per_channel": 2}
    config = Configuration(**choices)
    built = Structure(
        hdl_parameters(config),
        device={"configuration": choices},
        roms=lambda folder: write_roms(folder, synthetic_for(config), config),
    )
    return Case(WHOLE, f"{WHOLE}-{solver}", built, WHOLE_LEVELS)


def netlist(case: Case, folder: Path) -> dict[str, int]:
    """Write netlist.v and wrapper.sv; return the number of cells by type. Raises RuntimeError."""
    core, outside = case.core, repository.mutants(case.core).outside
    if case.structure.roms:
        case.structure.roms(folder)
    top = f"{core}_netlist"
    synth = f"synth_xilinx -family xc7 -noiopad -noclkbuf -flatten -top {top}"
    mutants.yosys(
        f"{mutants.base(core, case.structure, outside)}rename {core} {top}\n{synth} -run begin:map_memory\n"
        f"opt -fast -full\n{synth} -run fine:edif\ntee -q -o cells.json stat -json\nwrite_verilog -noattr netlist.v\n",
        folder,
        "netlist",
    )
    (folder / "wrapper.sv").write_text(mutants.wrapper(core, folder, selector=""))
    return json.loads((folder / "cells.json").read_text())["modules"][f"\\{top}"]["num_cells_by_type"]


def run(case: Case, seed: int) -> Result:
    """Synthesise a structure and run its testbench on the netlist. Raises RuntimeError."""
    began = time.monotonic()
    folder = OUT / case.name
    folder.mkdir(parents=True, exist_ok=True)
    cells = netlist(case, folder)
    (folder / "waivers.vlt").write_text(mutants.AS_IT_IS + LIBRARY_AS_IT_IS)
    files = [folder / "waivers.vlt", yosys.in_wheel("pyosys", LIBRARY), folder / "netlist.v", folder / "wrapper.sv"]
    count = failed = 0
    for simulator, level in case.levels.items():
        place = folder / simulator
        simulation.build(
            simulator,
            case.core,
            [*repository.packages(), *files],
            case.structure.parameters,
            place,
            fast=True,
            log=folder / f"{simulator}-build.log",
        )
        ran, wrong = simulation.run(
            case.core,
            repository.testbench(case.core),
            place,
            folder,
            simulator=simulator,
            seed=seed,
            environment=RunSettings(netlist=True, level=level, device=case.structure.device).environment,
            log=folder / f"{simulator}.log",
        )
        count, failed = count + ran, failed + wrong
    return Result(case, cells, count, failed, time.monotonic() - began)


COLUMNS_SHOWN = {"LUT": 7, "FF": 7, "DSP": 5, "memories": 10, "tests": 7, "failed": 8, "seconds": 9}
HEAD = f"{'netlist':<28}" + "".join(f"{name:>{width}}" for name, width in COLUMNS_SHOWN.items())


def row(result: Result) -> str:
    cells = Counter(result.cells)
    luts = sum(count for cell, count in cells.items() if cell.startswith(("LUT", "INV", "SRL")))
    registers = sum(count for cell, count in cells.items() if cell.startswith("FD"))
    numbers = (luts, registers, cells["DSP48E1"], cells["$mem_v2"], result.tests, result.failed, round(result.seconds))
    shown = "".join(f"{number:>{width},}" for number, width in zip(numbers, COLUMNS_SHOWN.values(), strict=True))
    verdict = "" if result.tests and not result.failed else "  DIFFERS"
    return f"{result.case.name:<28}{shown}{verdict}"


def main(cores: repository.Cores | None = None, seed: Seed = 1) -> int:
    names = repository.tested(mutate.cores() if cores is None else cores)
    yosys.in_wheel("pyosys", LIBRARY)
    for simulator in WHOLE_LEVELS:
        simulation.check(simulator)
    settings = RunSettings(cores=tuple(names))
    return items.run([ITEMS], table, marks="netlist", verbose=True, settings=settings, SEED=str(seed))[0]


def table(outcomes: Sequence[items.Item]) -> str:
    """Return a row for each netlist, the number of netlists, and those that differ."""
    wrong = [item for item in outcomes if item.failure]
    rows = [item.recorded.get("row", f"{item.name}: {item.failure}") for item in outcomes]
    tests = sum(item.recorded.get("tests", 0) for item in outcomes)
    cores = {item.recorded.get("core", item.name) for item in outcomes}
    total = f"netlists: {len(outcomes)} of {len(cores)} cores, {tests:,} tests"
    verdict = f", not as the RTL: {', '.join(item.name for item in wrong)}" if wrong else ": all as the RTL"
    return "\n".join([HEAD, *rows, total + verdict])
