# SPDX-License-Identifier: Apache-2.0
"""multiply: RTL against the model, the model against Python's integers."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.common.td_multiply import multiply


@pytest.mark.structures(
    "a_width b_width", verilator=[(27, 18)], icarus=[(35, 24)], regress=[(15, 10), (2, 3), (27, 18)]
)
def test_rtl(run_tb: Callable[..., None], a_width: int, b_width: int) -> None:
    run_tb("td_multiply", {"AWidth": a_width, "BWidth": b_width})


@given(st.integers(-(2**34), 2**34 - 1), st.integers(-(2**23), 2**23 - 1))  # the widest that occur
def test_model_is_exact(a: Any, b: Any) -> None:
    assert multiply(np.array(a), np.array(b)) == a * b
