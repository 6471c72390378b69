# SPDX-License-Identifier: Apache-2.0
"""ramp: RTL against the model, the model against Python's integers."""

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.common.td_ramp import ramp


@given(st.integers(0, 2**40 - 1), st.integers(-(2**36), 2**36 - 1))  # the widest that occur
def test_model_is_exact(first: Any, step: Any) -> None:
    words = ramp(np.array(first), np.array(step), 8, 40)
    assert words.tolist() == [(first + n * step) % 2**40 for n in range(8)]
