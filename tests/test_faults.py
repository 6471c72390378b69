# SPDX-License-Identifier: Apache-2.0
"""Stream contract of tactile_depth: every break at every position, resets in every phase.

Icarus is a hundred times slower than Verilator, so `make test` takes a sample and `make regress` (REGRESS=1) the rest:

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
from itertools import groupby
from pathlib import Path
from typing import Any

import pytest

from tactile_depth.configuration import Configuration
from tb.stream import REGRESS
from tests.attack import PROFILES, Attack, Outcome, Reset, attack, cases, phases, resets
from tests.conftest import SEED
from tests.records import record

TIMEOUT = 100
GRIDS: dict[str, Any] = {
    "tridiagonal-8x16-neumann": {"columns": 16, "rows": 8, "solver": "tridiagonal", "neumann": True},
    "spectral-16": {"columns": 16},
    "spectral-16-neumann": {"columns": 16, "neumann": True},
    "tridiagonal-16": {"columns": 16, "solver": "tridiagonal"},
    "tridiagonal-16-neumann": {"columns": 16, "solver": "tridiagonal", "neumann": True},
}
SMALLEST = "tridiagonal-8x16-neumann"
EVERY = [(grid,) for grid in GRIDS]
STRIDE = {"verilator": 16, "icarus": 32}
SMALLEST_STRIDE = {"verilator": 1, "icarus": 8} if REGRESS else {"verilator": 8, "icarus": 40}
PHASES = {"verilator": 3, "icarus": 128}  # one in so many; REGRESS: each, with each number of clocks; Icarus 1 in 16
CLOCKS = (1, 2, 16)  # of a reset
SINKS = ("none", *(name for name in PROFILES if name != "none"), "full")


@pytest.fixture
def device(simulator: str, tmp_path: Path) -> Any:
    return lambda config: Attack(simulator, config, tmp_path, SEED)


def chosen(simulator: str, grid: Any, stalled: bool, silent: bool) -> Any:
    """Return the cases in a random order that differs for each device."""
    rng = random.Random(f"{SEED} {simulator} {grid.removesuffix('-neumann')} {silent}")
    config = Configuration(**GRIDS[grid])
    out = cases(config.rows, config.columns, silent)
    if not REGRESS or simulator == "icarus":  # of each break and position one
        out = [rng.choice(list(alike)) for _, alike in groupby(out, lambda case: (case.kind, case.position))]
    rng.shuffle(out)
    if simulator == "icarus":
        out = out[stalled::2] if grid == SMALLEST else out[stalled + 2 * config.neumann :: 4]
    return out[:: SMALLEST_STRIDE[simulator] if grid == SMALLEST else 1 if REGRESS else STRIDE[simulator]]


def note(what: Any, simulator: str, grid: Any, out: Outcome, began: Any) -> None:
    record(
        part="faults",
        grid=grid,
        what=f"{what}, {grid}",
        simulator=simulator,
        **out.__dict__,
        seconds=time.monotonic() - began,
    )


@pytest.mark.structures("grid", both=EVERY[:1], verilator=EVERY[1:2], regress=EVERY[1:], regress_verilator=EVERY[2:])
@pytest.mark.parametrize("silent", [False, True], ids=["register-off", "register-on"])
@pytest.mark.parametrize("stalled", [False, True], ids=["flowing", "stalled"])
def test_every_break_at_every_position(device: Any, simulator: str, grid: Any, stalled: Any, silent: Any) -> None:
    some, began = chosen(simulator, grid, stalled, silent), time.monotonic()
    out = attack(device(Configuration(**GRIDS[grid])), some, stalled=stalled, timeout=TIMEOUT if silent else 0)
    note(("stalled" if stalled else "flowing") + (", time-out on" if silent else ""), simulator, grid, out, began)


@pytest.mark.structures("grid", both=EVERY[:1], verilator=EVERY[1:2], regress=EVERY[1:], regress_verilator=EVERY[2:])
def test_resets_in_every_phase(device: Any, simulator: str, grid: Any) -> None:
    config, began = Configuration(**GRIDS[grid]), time.monotonic()
    every = phases(config)
    full = REGRESS and simulator == "verilator"
    stride = 1 if full else PHASES[simulator] // (8 if REGRESS else 1)
    lengths = CLOCKS if full else (0,)
    some = [
        Reset(phase, clocks or CLOCKS[index % len(CLOCKS)], SINKS[(index // len(CLOCKS) + clocks) % len(SINKS)])
        for index, phase in enumerate(every[(SEED + config.neumann * stride // 2) % stride :: stride])
        for clocks in lengths
    ]
    note("resets", simulator, grid, resets(device(config), some), began)


@pytest.mark.regress
@pytest.mark.parametrize("simulator", ["verilator"], indirect=True)
@pytest.mark.parametrize(("solver", "lanes"), [("tridiagonal", 1), ("tridiagonal", 32), ("spectral", 1)])
def test_a_sample_at_128(device: Any, simulator: Any, solver: Any, lanes: int) -> None:
    """Send whole frames of 16,384 pixels, with each kind of break at a random position, and resets."""
    config, rng = Configuration(columns=128, solver=solver, lanes=lanes), random.Random(SEED)
    grid = f"{solver}-128" + (f"-{lanes}-lanes" if lanes > 1 else "")
    for stalled, silent in ((False, False), (True, False), (False, True)):
        began = time.monotonic()
        every = cases(config.rows, config.columns, silent)
        kinds = sorted({case.kind for case in every})
        some = [rng.choice([c for c in every if c.kind == kind]) for kind in kinds for _ in range(8 if REGRESS else 1)]
        out = attack(device(config), some, stalled=stalled, timeout=TIMEOUT if silent else 0)
        note("sample", simulator, grid, out, began)
    began = time.monotonic()
    drawn = [Reset(rng.choice(phases(config)), clocks, rng.choice(SINKS)) for clocks in CLOCKS]
    note("resets", simulator, grid, resets(device(config), drawn), began)
