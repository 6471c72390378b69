# SPDX-License-Identifier: Apache-2.0
"""divide: RTL against the model, the model against its definition."""

from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.common.td_divide import divide


@pytest.mark.structures(
    "divisor_width quotient_width", verilator=[(24, 25)], icarus=[(6, 5), (3, 9)], regress=[(1, 2), (15, 12)]
)
def test_rtl(run_tb: Callable[..., None], divisor_width: int, quotient_width: int) -> None:
    run_tb("td_divide", {"DivisorWidth": divisor_width, "QuotientWidth": quotient_width})


@given(st.integers(0, 2**20 - 1), st.integers(0, 2**10 - 1), st.integers(2, 20))
def test_quotient_and_remainder_make_the_numerator(numerator: int, divisor: int, quotient_bits: int) -> None:
    result = divide(numerator, divisor, quotient_bits)
    if result is None:
        assert numerator >= divisor << quotient_bits
    else:
        quotient, remainder = result
        assert numerator == quotient * divisor + remainder
        assert 0 <= quotient < 1 << quotient_bits
        assert 0 <= remainder < divisor
