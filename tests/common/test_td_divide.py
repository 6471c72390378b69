# SPDX-License-Identifier: Apache-2.0
"""divide: RTL against the model, the model against its definition."""

from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.common.td_divide import divide


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
