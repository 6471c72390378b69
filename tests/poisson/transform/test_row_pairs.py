# SPDX-License-Identifier: Apache-2.0
"""row_pairs: RTL against the model, the model against complex rows."""

import numpy as np

from tactile_depth.chip.poisson.transform.orders import mirror
from tactile_depth.chip.poisson.transform.row_pairs import row_pairs


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
