# SPDX-License-Identifier: Apache-2.0
"""round_divide: RTL against the model, the model against Python's own rounding of fractions."""

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.camera.round_divide import WHITE, round_divide
from tb.structures import BOTH, ICARUS, VERILATOR, Mutants, Structure


def built(total_width: int, weight_width: int, drop: int, **runs: Any) -> Structure:
    return Structure({"TotalWidth": total_width, "WeightWidth": weight_width, "Drop": drop}, **runs)


STRUCTURES = (
    built(36, 8, 14, on=BOTH),
    built(12, 1, 2, on=ICARUS, late=VERILATOR),
    built(17, 7, 2, on=ICARUS, mutants=True),
    built(20, 3, 4),
    built(50, 25, 16),
)
MUTANTS = Mutants(repeats=2)
REFUSED = {
    "TotalWidth=9": "TotalWidth_must_be_at_least_10_plus_Drop_WeightWidth_at_least_1_and_Drop_at_least_2",
    "WeightWidth=0": "TotalWidth_must_be_at_least_10_plus_Drop_WeightWidth_at_least_1_and_Drop_at_least_2",
    "Drop=1": "TotalWidth_must_be_at_least_10_plus_Drop_WeightWidth_at_least_1_and_Drop_at_least_2",
}


def test_rtl(run_tb: Callable[..., None], structure: Structure) -> None:
    run_tb(structure)


@given(st.integers(-(2**37), 2**37 - 1), st.integers(1, 2**25 - 1), st.integers(0, 4))
def test_rounding_is_that_of_fractions(total: int, weight: int, drop: int) -> None:
    rounded = round(Fraction(total, weight << drop))
    assert round_divide(np.array([total]), weight, drop) == [min(max(rounded, 0), WHITE)]
