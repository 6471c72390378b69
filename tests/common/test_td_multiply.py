# SPDX-License-Identifier: Apache-2.0
"""multiply: RTL against the model, the model against Python's integers."""

from collections.abc import Callable
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.common.td_multiply import multiply
from tb.structures import ICARUS, VERILATOR, Structure


def built(a_width: int, b_width: int, **runs: Any) -> Structure:
    return Structure({"AWidth": a_width, "BWidth": b_width}, **runs)


STRUCTURES = (
    built(27, 18, on=VERILATOR),
    built(35, 24, on=ICARUS),
    built(15, 10, mutants=True),
    built(2, 3),
)


def test_rtl(run_tb: Callable[..., None], structure: Structure) -> None:
    run_tb(structure)


@given(st.integers(-(2**34), 2**34 - 1), st.integers(-(2**23), 2**23 - 1))  # the widest that occur
def test_model_is_exact(a: Any, b: Any) -> None:
    assert multiply(np.array(a), np.array(b)) == a * b
