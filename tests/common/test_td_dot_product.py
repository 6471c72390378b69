# SPDX-License-Identifier: Apache-2.0
"""td_dot_product: RTL against the model, the model against Python's integers."""

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from formal.entries import Proof
from tactile_depth.chip.common.td_dot_product import dot_product
from tb.structures import ICARUS, VERILATOR, of_parameters
from tests.rtl import test_rtl as test_rtl

A, B = st.integers(-(2**34), 2**34 - 1), st.integers(-(2**23), 2**23 - 1)  # the widest that occur


built = of_parameters("AWidth BWidth")
STRUCTURES = (
    built(27, 18, on=VERILATOR),
    built(15, 10, on=ICARUS),
    built(35, 24),
    built(4, 3, mutants=True),
)
PROOFS = (Proof("the exact sum of two products, 4 enabled clocks later", "no control but en; no width enters"),)


@given(A, B, A, B)
def test_model_is_exact(a0: Any, b0: Any, a1: Any, b1: Any) -> None:
    assert dot_product(*map(np.array, (a0, b0, a1, b1))) == a0 * b0 + a1 * b1
