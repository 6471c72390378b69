# SPDX-License-Identifier: Apache-2.0
"""td_dot_product: RTL against the model, the model against Python's integers."""

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.common.td_dot_product import dot_product

A, B = st.integers(-(2**34), 2**34 - 1), st.integers(-(2**23), 2**23 - 1)  # the widest that occur


@given(A, B, A, B)
def test_model_is_exact(a0: Any, b0: Any, a1: Any, b1: Any) -> None:
    assert dot_product(*map(np.array, (a0, b0, a1, b1))) == a0 * b0 + a1 * b1
