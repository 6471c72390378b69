# SPDX-License-Identifier: Apache-2.0
"""round_divide: RTL against the model, the model against Python's own rounding of fractions."""

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.camera.round_divide import WHITE, round_divide


@pytest.mark.structures(
    "total_width weight_width drop",
    verilator=[(36, 8, 14)],
    icarus=[(36, 8, 14), (12, 1, 2), (17, 7, 2)],
    regress=[(20, 3, 4), (50, 25, 16)],
    regress_verilator=[(12, 1, 2)],
)
def test_rtl(run_tb: Callable[..., None], total_width: int, weight_width: int, drop: int) -> None:
    run_tb("round_divide", {"TotalWidth": total_width, "WeightWidth": weight_width, "Drop": drop})


@given(st.integers(-(2**37), 2**37 - 1), st.integers(1, 2**25 - 1), st.integers(0, 4))
def test_rounding_is_that_of_fractions(total: int, weight: int, drop: int) -> None:
    rounded = round(Fraction(total, weight << drop))
    assert round_divide(np.array([total]), weight, drop) == [min(max(rounded, 0), WHITE)]
