# SPDX-License-Identifier: Apache-2.0
"""corner_turn and row_order: RTL against the models, the order of their words."""

import numpy as np

from tactile_depth.chip.poisson.transform.corner_turn import corner_turn
from tactile_depth.chip.poisson.transform.row_order import row_order


def test_the_order_of_makhoul() -> None:
    assert row_order(np.arange(8)).tolist() == [0, 2, 4, 6, 7, 5, 3, 1]


def test_a_corner_turn_brings_rows_back() -> None:
    rows = np.random.default_rng(1).integers(0, 99, (3, 32))
    np.testing.assert_array_equal(corner_turn(row_order(rows)), rows)
