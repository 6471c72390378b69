# SPDX-License-Identifier: Apache-2.0
"""round_divide: RTL against the model, the model against Python's own rounding of fractions."""

from fractions import Fraction

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from formal.entries import Proof
from tactile_depth.chip.camera.round_divide import WHITE, round_divide
from tb.structures import BOTH, ICARUS, VERILATOR, Mutants, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("TotalWidth WeightWidth Drop")
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
PROOFS = (
    Proof(
        "the nearest integer, ties to even, clipped to 0..255; latency 10",
        "a stage for each bit of the quotient, the same at every width of the divisor",
        {"TotalWidth": 13, "WeightWidth": 2, "Drop": 3},
    ),
)


@given(st.integers(-(2**37), 2**37 - 1), st.integers(1, 2**25 - 1), st.integers(0, 4))
def test_rounding_is_that_of_fractions(total: int, weight: int, drop: int) -> None:
    rounded = round(Fraction(total, weight << drop))
    assert round_divide(np.array([total]), weight, drop) == [min(max(rounded, 0), WHITE)]
