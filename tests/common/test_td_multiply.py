# SPDX-License-Identifier: Apache-2.0
"""multiply: RTL against the model, the model against Python's integers."""

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from formal.entries import Proof
from tactile_depth.chip.common.td_multiply import multiply
from tb.structures import ICARUS, VERILATOR, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("AWidth BWidth")
STRUCTURES = (
    built(27, 18, on=VERILATOR),
    built(35, 24, on=ICARUS),
    built(15, 10, mutants=True),
    built(2, 3),
)
PROOFS = (Proof("the exact product of every enabled clock's operands", "no control but en; no width enters"),)


@given(st.integers(-(2**34), 2**34 - 1), st.integers(-(2**23), 2**23 - 1))  # the widest that occur
def test_model_is_exact(a: Any, b: Any) -> None:
    assert multiply(np.array(a), np.array(b)) == a * b
