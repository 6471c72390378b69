# SPDX-License-Identifier: Apache-2.0
"""ramp: RTL against the model, the model against Python's integers."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.common.td_ramp import ramp


@pytest.mark.structures(
    "width step_width count",
    verilator=[(32, 29, 8)],
    icarus=[(8, 8, 1), (10, 6, 4)],
    regress=[(32, 29, 8), (9, 5, 2), (40, 37, 32)],
)
def test_rtl(run_tb: Callable[..., None], width: int, step_width: int, count: int) -> None:
    run_tb("td_ramp", {"Width": width, "StepWidth": step_width, "Count": count})


@given(st.integers(0, 2**40 - 1), st.integers(-(2**36), 2**36 - 1))  # the widest that occur
def test_model_is_exact(first: Any, step: Any) -> None:
    words = ramp(np.array(first), np.array(step), 8, 40)
    assert words.tolist() == [(first + n * step) % 2**40 for n in range(8)]
