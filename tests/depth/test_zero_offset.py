# SPDX-License-Identifier: Apache-2.0
"""zero_offset: RTL against the model, and the model against its definition."""

from typing import Any

import numpy as np
import pytest

from tactile_depth.chip.common.td_node_map import node_map
from tactile_depth.chip.common.td_round_saturate import Monitor
from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.depth.zero_capture import captured_zero
from tactile_depth.chip.depth.zero_offset import exact_zero, no_zero, zero_offset

CONFIG = Configuration(columns=32, rows=21, solver="tridiagonal")
HIGHEST = (1 << CONFIG.depth.width - 1) - 1


def codes(count: int = 2, limit: int = HIGHEST) -> Any:
    return np.random.default_rng(1).integers(-limit - 1, limit, (count, 21, 32), endpoint=True)


def test_no_zero_changes_nothing() -> None:
    monitor = Monitor()
    np.testing.assert_array_equal(zero_offset(codes(), no_zero(CONFIG), CONFIG, monitor), codes())
    assert not monitor.saturations


@pytest.mark.parametrize("level", [-1000, -1, 1, 77777])
def test_a_flat_zero_is_subtracted_everywhere(level: int) -> None:
    zero = np.full(CONFIG.reference_nodes, level)
    assert np.all(node_map(zero, CONFIG) == level)
    low = codes(limit=HIGHEST // 2)
    np.testing.assert_array_equal(zero_offset(low, zero, CONFIG), low - level)


def test_what_is_clipped_is_counted() -> None:
    monitor = Monitor()
    zero = np.full(CONFIG.reference_nodes, -2)
    depths = np.zeros((21, 32), np.int64)
    depths[3, 4:9] = HIGHEST - np.arange(5)
    zeroed = zero_offset(depths, zero, CONFIG, monitor)
    assert zeroed[3, 4:9].tolist() == [HIGHEST, HIGHEST, HIGHEST, HIGHEST - 1, HIGHEST - 2]
    assert monitor.saturations == {"zero_offset": 2}
    zero_offset(np.full((21, 32), -HIGHEST - 1), np.full(CONFIG.reference_nodes, 1), CONFIG, monitor)
    assert monitor.saturations == {"zero_offset": 2 + 21 * 32}


def test_exact_zero_is_the_same_but_for_rounding() -> None:
    untouched, depths = codes(4, 5000), codes(3, 100000)
    zeroed = zero_offset(depths, captured_zero(untouched, CONFIG), CONFIG)
    exact = exact_zero(depths.astype(float), untouched.astype(float), CONFIG)
    assert 0 < np.abs(zeroed - exact).max() <= 1


def test_a_zero_that_is_a_plane_is_taken_off_between_the_centres_of_blocks() -> None:
    """Subtract a plane. In a cut row of blocks, which has no node, and beyond the outermost centres the zero offset is
    constant."""
    row, column = np.mgrid[:21, :32]
    plane = 400 * row - 600 * column + 5000
    zeroed = zero_offset(plane, captured_zero(plane[None], CONFIG), CONFIG)
    assert not zeroed[1:19, 1:31].any()
    assert zeroed[20].any()
