# SPDX-License-Identifier: Apache-2.0
"""round_divide: RTL against the model, the model against Python's own rounding of fractions."""

from fractions import Fraction

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.camera.round_divide import WHITE, round_divide


@given(st.integers(-(2**37), 2**37 - 1), st.integers(1, 2**25 - 1), st.integers(0, 4))
def test_rounding_is_that_of_fractions(total: int, weight: int, drop: int) -> None:
    rounded = round(Fraction(total, weight << drop))
    assert round_divide(np.array([total]), weight, drop) == [min(max(rounded, 0), WHITE)]
