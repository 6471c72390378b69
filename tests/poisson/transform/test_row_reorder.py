# SPDX-License-Identifier: Apache-2.0
"""row_reorder: RTL against the model, the model against Makhoul's order."""

import numpy as np
import pytest

from tactile_depth.chip.poisson.transform.row_reorder import row_reorder


def test_makhoul_order_is_even_samples_up_then_odd_ones_down() -> None:
    assert row_reorder(np.arange(8), to_burst=True).tolist() == [0, 2, 4, 6, 7, 5, 3, 1]


@pytest.mark.parametrize("columns", [8, 128, 512])
def test_there_and_back_is_the_row(columns: int) -> None:
    rows = np.arange(3 * columns).reshape(3, columns)
    for first in (True, False):
        np.testing.assert_array_equal(row_reorder(row_reorder(rows, first), not first), rows)
