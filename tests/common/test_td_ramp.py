# SPDX-License-Identifier: Apache-2.0
"""ramp: RTL against the model, the model against Python's integers."""

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from formal.entries import Proof
from tactile_depth.chip.common.td_ramp import ramp
from tb.structures import ICARUS, VERILATOR, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("Width StepWidth Count")
STRUCTURES = (
    built(32, 29, 8, on=VERILATOR),
    built(8, 8, 1, on=ICARUS),
    built(10, 6, 4, on=ICARUS, mutants=True),
    built(9, 5, 2),
    built(40, 37, 32),
)
REFUSED = {
    "Count=0": "Count_must_be_a_power_of_two",
    "Count=3": "Count_must_be_a_power_of_two",
    "StepWidth=33": "StepWidth_must_be_at_most_Width",
}
PROOFS = tuple(
    Proof(
        "an arbitrary word is the first and so many steps, log2(Count) enabled clocks later",
        "sums are exact at any width; no tree, and one of two levels",
        {"Count": count},
    )
    for count in (1, 4)
)


@given(st.integers(0, 2**40 - 1), st.integers(-(2**36), 2**36 - 1))  # the widest that occur
def test_model_is_exact(first: Any, step: Any) -> None:
    words = ramp(np.array(first), np.array(step), 8, 40)
    assert words.tolist() == [(first + n * step) % 2**40 for n in range(8)]
