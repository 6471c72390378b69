# SPDX-License-Identifier: Apache-2.0
"""wide_dst_forward: RTL against the model of dst_forward."""

import numpy as np
import pytest

from tactile_depth.chip.poisson.transform.dst_forward import dst_forward
from tactile_depth.chip.poisson.transform.orders import makhoul
from tactile_depth.chip.poisson.transform.transform import Transform
from tactile_depth.chip.poisson.transform.wide_dst_forward import wide_dst_forward
from tactile_depth.chip.poisson.transform.wide_rows import wide_rows


@pytest.mark.parametrize("words", [2, 4, 8])
def test_the_modes_of_a_row_are_those_of_dst_forward(words: int) -> None:
    row = np.random.default_rng(words).integers(-(2**20), 2**20, 32)
    want = dst_forward(row[makhoul(32)], Transform(0, 27, 18, 1, 27))
    np.testing.assert_array_equal(wide_dst_forward(wide_rows(row, words), Transform(0, 27, 18, 1, 27)).ravel(), want)
