# SPDX-License-Identifier: Apache-2.0
"""thomas_table: RTL against the model, the model against the recurrence and a direct solve."""

import math
from typing import Any

import numpy as np
import pytest

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.poisson.thomas_table import thomas_table
from tactile_depth.chip.poisson.transform.orders import eigenvalues


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
