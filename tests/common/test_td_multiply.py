# SPDX-License-Identifier: Apache-2.0
"""multiply: RTL against the model, the model against Python's integers."""

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.common.td_multiply import multiply


@given(st.integers(-(2**34), 2**34 - 1), st.integers(-(2**23), 2**23 - 1))  # the widest that occur
def test_model_is_exact(a: Any, b: Any) -> None:
    assert multiply(np.array(a), np.array(b)) == a * b
