# SPDX-License-Identifier: Apache-2.0
"""row_pairs: RTL against the model, the model against complex rows."""

import numpy as np
import pytest

from tactile_depth.chip.poisson.transform.orders import bit_reversed, mirror
from tactile_depth.chip.poisson.transform.row_pairs import mode_pairs, row_pairs


@pytest.mark.parametrize("size", [8, 16, 128, 512])
def test_mode_k_meets_mode_n_minus_k_and_mode_n_is_zero(size: int) -> None:
    by_mode = np.append(np.arange(1, size + 1), 0)  # mode k holds k + 1, and mode N nothing
    k = bit_reversed(size)
    mode, mirrored = mode_pairs(by_mode[k])
    np.testing.assert_array_equal(mode, by_mode[k])
    np.testing.assert_array_equal(mirrored, by_mode[size - k])


def test_pairs_are_the_modes_of_a_complex_row() -> None:
    a, b = np.random.default_rng(1).integers(-1000, 1000, (2, 16))
    re, im = row_pairs(a, b, 27)
    complex_row = a + 1j * b
    mirrored = complex_row[mirror(16)]
    mirrored[0] = 0
    np.testing.assert_array_equal(re + 1j * im, mirrored + 1j * complex_row)


def test_sums_saturate() -> None:
    a, b = np.full(8, 127), np.full(8, -128)
    re, im = row_pairs(a, b, 8)
    assert re.tolist() == [127] * 8
    assert im.tolist() == [127, *[-1] * 7]
