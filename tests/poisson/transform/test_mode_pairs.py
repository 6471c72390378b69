# SPDX-License-Identifier: Apache-2.0
"""mode_pairs: RTL against the model, the model against the definition."""

import numpy as np
import pytest

from tactile_depth.chip.poisson.transform.mode_pairs import mode_pairs
from tactile_depth.chip.poisson.transform.orders import bit_reversed, mirror


@pytest.mark.parametrize("size", [8, 16, 128, 512])
def test_mode_k_meets_mode_n_minus_k_and_mode_n_is_zero(size: int) -> None:
    by_mode = np.append(np.arange(1, size + 1), 0)  # mode k holds k + 1, and mode N nothing
    k = bit_reversed(size)
    mode, mirrored = mode_pairs(by_mode[k])
    np.testing.assert_array_equal(mode, by_mode[k])
    np.testing.assert_array_equal(mirrored, by_mode[size - k])


@pytest.mark.parametrize("size", [8, 64, 512])
def test_orders_are_their_own_inverses(size: int) -> None:
    for order in (bit_reversed(size), mirror(size)):
        np.testing.assert_array_equal(order[order], np.arange(size))
