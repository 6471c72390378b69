# SPDX-License-Identifier: Apache-2.0
"""wide_corner_turn: RTL against the model, the order of its words."""

import numpy as np
import pytest

from tactile_depth.chip.poisson.transform.orders import makhoul
from tactile_depth.chip.poisson.transform.wide_corner_turn import wide_corner_turn


@pytest.mark.parametrize("paths", [1, 2, 8])
def test_beats_have_neighbours(paths: int) -> None:
    beats = wide_corner_turn(makhoul(32), paths)
    np.testing.assert_array_equal(beats, np.arange(32).reshape(-1, 2 * paths))
