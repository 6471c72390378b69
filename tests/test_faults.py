# SPDX-License-Identifier: Apache-2.0
"""Stream contract of tactile_depth: every break at every position, resets in every phase.

Icarus is a hundred times slower than Verilator, so `make test` takes a sample and `make regress` (a full run) the rest:

                make test                              make regress
    Verilator   two grids: of all pairs of break and   five grids: the full product of breaks, positions and what
                position one in 8 on the smaller and   follows, with and without stalls; a sample at 128 x 128
                one in 16 on the other
    Icarus      one in 40 of it on the smallest grid   every break at every position of 16 x 16, one of what can
                                                       follow drawn for each; stalled half of them, and of a
                                                       solver's two boundaries one; the smallest grid as on the left
"""

import random
import time
from collections.abc import Callable
from itertools import groupby
from pathlib import Path
from typing import Any

import pytest

from conftest import SEED
from tactile_depth.chip.configuration import Configuration
from tb.settings import RUN
from tb.structures import BOTH, VERILATOR, Structure
from tests.attack import PROFILES, Attack, Outcome, Reset, attack, cases, phases, resets

TIMEOUT = 100
SMALLEST = "tridiagonal-8x16-neumann"


def built(name: str, choices: dict[str, Any], **runs: Any) -> Structure:
    return Structure(device={"configuration": choices}, name=name, **runs)


STRUCTURES = (
    built(SMALLEST, {"columns": 16, "rows": 8, "solver": "tridiagonal", "neumann": True}, on=BOTH),
    built("spectral-16", {"columns": 16}, on=VERILATOR),
    built("spectral-16-neumann", {"columns": 16, "neumann": True}),
    built("tridiagonal-16", {"columns": 16, "solver": "tridiagonal"}),
    built("tridiagonal-16-neumann", {"columns": 16, "solver": "tridiagonal", "neumann": True}),
)
STRIDE = 32
SMALLEST_STRIDE = {"verilator": 1, "icarus": 8} if RUN.full else {"verilator": 16, "icarus": 40}
PHASES = {"verilator": 3, "icarus": 128}  # one in so many; a full run: each, with each number of clocks; Icarus 1 in 16
CLOCKS = (1, 2, 16)  # of a reset
SINKS = ("none", *(name for name in PROFILES if name != "none"), "full")


@pytest.fixture
def device(simulator: str, tmp_path: Path) -> Any:
    return lambda config: Attack(simulator, config, tmp_path, SEED)


def chosen(simulator: str, grid: str, config: Configuration, stalled: bool, silent: bool) -> Any:
    """Return the cases in a random order that differs for each device."""
    rng = random.Random(f"{SEED} {simulator} {grid.removesuffix('-neumann')} {silent}")
    out = cases(config.rows, config.columns, silent)
    if not RUN.full or simulator == "icarus":  # of each break and position one
        out = [rng.choice(list(alike)) for _, alike in groupby(out, lambda case: (case.kind, case.position))]
    rng.shuffle(out)
    if simulator == "icarus":
        out = out[stalled::2] if grid == SMALLEST else out[stalled + 2 * config.neumann :: 4]
    return out[:: SMALLEST_STRIDE[simulator] if grid == SMALLEST else 1 if RUN.full else STRIDE]


@pytest.fixture
def note(simulator: str, record_property: Callable[[str, object], None]) -> Any:
    """Return a function that records the outcome of an attack for the table of `make regress`."""

    records: list[dict[str, Any]] = []
    record_property("records", records)

    def record(what: str, grid: str, out: Outcome, began: float) -> None:
        figures = {"part": "faults", "grid": grid, "what": f"{what}, {grid}", "simulator": simulator}
        records.append(figures | out.__dict__ | {"seconds": time.monotonic() - began})

    return record


@pytest.mark.parametrize("silent", [False, True], ids=["register-off", "register-on"])
@pytest.mark.parametrize("stalled", [False, True], ids=["flowing", "stalled"])
def test_every_break_at_every_position(
    device: Any, note: Any, simulator: str, structure: Structure, stalled: Any, silent: Any
) -> None:
    config, began = Configuration(**structure.device["configuration"]), time.monotonic()
    some = chosen(simulator, structure.name, config, stalled, silent)
    out = attack(device(config), some, stalled=stalled, timeout=TIMEOUT if silent else 0)
    note(("stalled" if stalled else "flowing") + (", time-out on" if silent else ""), structure.name, out, began)


def test_resets_in_every_phase(device: Any, note: Any, simulator: str, structure: Structure) -> None:
    config, began = Configuration(**structure.device["configuration"]), time.monotonic()
    every = phases(config)
    full = RUN.full and simulator == "verilator"
    stride = 1 if full else PHASES[simulator] // (8 if RUN.full else 1)
    lengths = CLOCKS if full else (0,)
    some = [
        Reset(phase, clocks or CLOCKS[index % len(CLOCKS)], SINKS[(index // len(CLOCKS) + clocks) % len(SINKS)])
        for index, phase in enumerate(every[(SEED + config.neumann * stride // 2) % stride :: stride])
        for clocks in lengths
    ]
    note("resets", structure.name, resets(device(config), some), began)


@pytest.mark.regress
@pytest.mark.parametrize("simulator", ["verilator"], indirect=True)
@pytest.mark.parametrize(("solver", "lanes"), [("tridiagonal", 1), ("tridiagonal", 32), ("spectral", 1)])
def test_a_sample_at_128(device: Any, note: Any, simulator: Any, solver: Any, lanes: int) -> None:
    """Send whole frames of 16,384 pixels, with each kind of break at a random position, and resets."""
    config, rng = Configuration(columns=128, solver=solver, lanes=lanes), random.Random(SEED)
    grid = f"{solver}-128" + (f"-{lanes}-lanes" if lanes > 1 else "")
    for stalled, silent in ((False, False), (True, False), (False, True)):
        began = time.monotonic()
        every = cases(config.rows, config.columns, silent)
        kinds = sorted({case.kind for case in every})
        some = [rng.choice([c for c in every if c.kind == kind]) for kind in kinds for _ in range(8 if RUN.full else 1)]
        out = attack(device(config), some, stalled=stalled, timeout=TIMEOUT if silent else 0)
        note("sample", grid, out, began)
    began = time.monotonic()
    drawn = [Reset(rng.choice(phases(config)), clocks, rng.choice(SINKS)) for clocks in CLOCKS]
    note("resets", grid, resets(device(config), drawn), began)
