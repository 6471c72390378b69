# SPDX-License-Identifier: Apache-2.0
"""td_dot_product: RTL against the model, the model against Python's integers."""

from collections.abc import Callable
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.common.td_dot_product import dot_product
from tb.structures import ICARUS, VERILATOR, Structure

A, B = st.integers(-(2**34), 2**34 - 1), st.integers(-(2**23), 2**23 - 1)  # the widest that occur


def built(a_width: int, b_width: int, **runs: Any) -> Structure:
    return Structure({"AWidth": a_width, "BWidth": b_width}, **runs)


STRUCTURES = (
    built(27, 18, on=VERILATOR),
    built(15, 10, on=ICARUS),
    built(35, 24),
    built(4, 3, mutants=True),
)


def test_rtl(run_tb: Callable[..., None], structure: Structure) -> None:
    run_tb(structure)


@given(A, B, A, B)
def test_model_is_exact(a0: Any, b0: Any, a1: Any, b1: Any) -> None:
    assert dot_product(*map(np.array, (a0, b0, a1, b1))) == a0 * b0 + a1 * b1
