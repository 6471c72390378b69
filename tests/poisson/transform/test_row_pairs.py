# SPDX-License-Identifier: Apache-2.0
"""row_pairs: RTL against the model, its sums at the limits."""

import numpy as np

from tactile_depth.chip.poisson.transform.row_pairs import row_pairs


def test_sums_saturate() -> None:
    a, b = np.full(8, 127), np.full(8, -128)
    re, im = row_pairs(a, b, 8)
    assert re.tolist() == [127] * 8
    assert im.tolist() == [127, *[-1] * 7]
