# SPDX-License-Identifier: Apache-2.0
"""wide_rows: RTL against the model, the order of its words."""

import numpy as np
import pytest

from tactile_depth.chip.poisson.transform.orders import makhoul
from tactile_depth.chip.poisson.transform.wide_rows import wide_rows


@pytest.mark.parametrize("paths", [2, 4, 8])
def test_a_path_has_neighbours_in_makhoul_order(paths: int) -> None:
    size = 16
    beats = wide_rows(np.arange(size), paths)
    np.testing.assert_array_equal(beats.T.ravel(), makhoul(size))
