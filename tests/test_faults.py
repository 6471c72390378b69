# SPDX-License-Identifier: Apache-2.0
"""The stream contract of tactile_depth under attack: every break at every position, whatever follows.

With REGRESS=1 the full product on everything; without, on Verilator, and on Icarus a part.
"""

import json
import random
import time

import pytest
from attack import Attack, attack, cases, record
from conftest import REGRESS, SEED

from models.configuration import Configuration

TIMEOUT = 100
GRIDS = {
    "tridiagonal-8x16": {"columns": 16, "rows": 8, "solver": "tridiagonal", "neumann": True},
    "spectral-16": {"columns": 16},
    "spectral-16-neumann": {"columns": 16, "neumann": True},
    "tridiagonal-16": {"columns": 16, "solver": "tridiagonal"},
    "tridiagonal-16-neumann": {"columns": 16, "solver": "tridiagonal", "neumann": True},
}
# Without REGRESS: one case of so many. Icarus is a hundred times slower.
SHARE = {"verilator": 1, "icarus": 60}


@pytest.fixture
def device(simulator, tmp_path, request):
    return lambda config: Attack(simulator, config, tmp_path, SEED)


def share(chosen, simulator, name):
    """All cases, in an order of their own for each device; without REGRESS every so-manieth on Icarus."""
    random.Random(f"{SEED} {simulator} {name}").shuffle(chosen)
    return chosen[:: 1 if REGRESS else SHARE[simulator]]


@pytest.mark.parametrize("silent", [False, True], ids=["register-off", "register-on"])
@pytest.mark.parametrize("stalled", [False, True], ids=["flowing", "stalled"])
@pytest.mark.parametrize("grid", GRIDS)
def test_every_break_at_every_position(device, simulator, grid, stalled, silent):
    config = Configuration(**GRIDS[grid])
    chosen = share(cases(config.rows, config.columns, silent), simulator, f"{grid} {stalled}")
    began = time.monotonic()
    out = attack(device(config), chosen, stalled=stalled, timeout=TIMEOUT if silent else 0)
    record(
        what=f"faults {grid}",
        simulator=simulator,
        cases=out.cases,
        faults=out.faults,
        codes=out.codes,
        seconds=time.monotonic() - began,
    )
    print(json.dumps([grid, simulator, stalled, silent, *out.__dict__.values(), time.monotonic() - began]))
