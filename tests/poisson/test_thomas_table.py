# SPDX-License-Identifier: Apache-2.0
"""thomas_table: RTL against the model, the model against the recurrence and a direct solve."""

import math
from typing import Any

import numpy as np
import pytest

from formal.entries import Proof
from formal.tables import thomas_roms
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.thomas_table import thomas_table
from tactile_depth.chip.poisson.transform.orders import eigenvalues
from tactile_depth.chip.poisson.tridiagonal_solver import solver_parameters
from tactile_depth.chip.rom_files import write_thomas
from tb.structures import ICARUS, VERILATOR, Structure
from tests.rtl import test_rtl as test_rtl

CHOICES = {"columns": 16, "rows": 8, "solver": "tridiagonal"}


def built(choices: Any, **runs: Any) -> Structure:
    config = Configuration(**choices)
    parameters = solver_parameters(config)
    taken = ("CoeffWidth", "Rows", "Columns", "SettledWidth", "LastShiftWidth")
    return Structure(
        {name: parameters[name] for name in taken} | {"Words": parameters["TableWords"]},
        device={"configuration": choices},
        roms=lambda folder: write_thomas(folder, config),
        **runs,
    )


STRUCTURES = (
    built(CHOICES | {"neumann": True}, on=VERILATOR, mutants=True),
    built(CHOICES, on=ICARUS),
    built(CHOICES | {"columns": 32, "rows": 50, "neumann": True}),
)
REFUSED = {
    "Columns=12": "Columns_must_be_a_power_of_two_at_least_2",
    "Rows=1": "Rows_must_be_at_least_2",
}
PROOFS = (
    Proof(
        "the coefficient of a row and position: base + min(row, settled), in the last row its own; latency 5",
        "every row and position of a table with all its cases; contents do not matter",
        {"Rows": 6, "Columns": 4, "Words": 14},
        roms=thomas_roms(6, 4, 14, 5, 3, 2),
    ),
)


@pytest.mark.parametrize("neumann", [False, True])
@pytest.mark.parametrize(("columns", "rows"), [(16, 8), (64, 64), (128, 100), (256, 240)])
def test_entries_solve_the_system(columns: int, rows: int, neumann: bool) -> None:
    config = Configuration(columns=columns, rows=rows, solver="tridiagonal", neumann=neumann)
    table = thomas_table(config)
    scale = 2.0 ** (1 - config.coefficient_width)
    c = np.vstack((table.rows(rows - 1) * scale, table.last * 2.0**table.last_shift * scale))
    end = 1 if neumann else 3
    for position, eigenvalue in enumerate(eigenvalues(columns, neumann)):
        if neumann and position == 0:
            assert c[-1, position] == 0, "the singular mode has no last coefficient"
            continue
        diagonal = np.full(rows, eigenvalue - 2)
        diagonal[[0, -1]] = eigenvalue - end
        system = np.diag(diagonal) + np.eye(rows, k=1) + np.eye(rows, k=-1)
        f = np.zeros(rows)
        f[rows // 3] = 1
        d = np.zeros(rows)
        for row in range(rows):
            d[row] = c[row, position] * (f[row] - (d[row - 1] if row else 0))
        z = d.copy()
        for row in range(rows - 2, -1, -1):
            z[row] = d[row] - c[row, position] * z[row + 1]
        want = np.linalg.solve(system, f)
        # An error e of c near -1 moves the eigenvalue by 2 e sqrt(-eigenvalue); e is 2^-18, the factor 8 covers rows.
        assert np.abs(z - want).max() < 8 * scale / math.sqrt(-eigenvalue) * np.abs(want).max()


@pytest.mark.parametrize(("size", "words"), [(64, 607), (128, 1379), (256, 3038), (512, 6473), (1024, 13822)])
def test_size_is_near_the_estimate(size: int, words: Any) -> None:
    table = thomas_table(Configuration(columns=size, solver="tridiagonal"))
    assert len(table.words) == words
    # 2 N / k rows to settle, for each mode k: 2 N (1 + ln(N / 2)) words; measured 18 % above that at 64, 0 % at 1024.
    assert len(table.words) + size < 1.2 * 2 * size * (1 + math.log(size / 2))
