# SPDX-License-Identifier: Apache-2.0
"""zero_capture: RTL against the model, and the model against exact fractions."""

from fractions import Fraction

import numpy as np
import pytest

from tactile_depth.chip.configuration import Configuration
from tactile_depth.chip.depth.zero_capture import captured_zero


@pytest.mark.parametrize("count", [1, 2, 8])
@pytest.mark.parametrize("limit", [2, 1 << 23])
def test_a_zero_is_the_mean_to_the_nearest_with_ties_to_even(count: int, limit: int) -> None:
    config = Configuration(columns=32, rows=21, solver="tridiagonal")
    frames = np.random.default_rng(count).integers(-limit, limit, (count, 21, 32))
    zero = captured_zero(frames, config)
    block = 1 << config.reference_block_log2
    for row, column in np.ndindex(*config.reference_nodes):
        words = frames[:, row * block : (row + 1) * block, column * block : (column + 1) * block]
        assert zero[row, column] == round(Fraction(int(words.sum()), words.size))
