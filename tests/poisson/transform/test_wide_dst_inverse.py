# SPDX-License-Identifier: Apache-2.0
"""wide_dst_inverse: RTL against the model, the model against dst_inverse."""

import numpy as np
import pytest

from tactile_depth.chip.poisson.transform.dst_inverse import dst_inverse
from tactile_depth.chip.poisson.transform.transform import Transform
from tactile_depth.chip.poisson.transform.wide_dst_inverse import wide_dst_inverse


# In steps of a word, coefficients being all but exact. Measured on 100 pairs of rows: 3, 4, 5.
@pytest.mark.parametrize(("size", "largest"), [(16, 4), (64, 5), (128, 6)])
def test_rows_of_a_pair_are_those_alone_within_steps(size: int, largest: int) -> None:
    modes = np.random.default_rng(size).integers(-(2**12), 2**12, (100, 2, size))
    pairs = wide_dst_inverse(modes, Transform(0, 30, 30, 0, 30))
    assert np.abs(pairs - dst_inverse(modes, Transform(0, 30, 30, 0, 30))).max() <= largest


def test_an_odd_row_is_one_beside_zeros() -> None:
    modes = np.random.default_rng(1).integers(-1000, 1000, (3, 16))
    rows = wide_dst_inverse(modes, Transform(0, 27, 18, 0, 27))
    beside = np.stack((modes[2], np.zeros(16, np.int64)))
    np.testing.assert_array_equal(rows[2], wide_dst_inverse(beside, Transform(0, 27, 18, 0, 27))[0])
