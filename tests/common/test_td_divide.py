# SPDX-License-Identifier: Apache-2.0
"""divide: RTL against the model, the model against its definition."""

from hypothesis import given
from hypothesis import strategies as st

from formal.entries import Proof
from tactile_depth.chip.common import td_divide
from tactile_depth.chip.common.td_divide import divide
from tb.structures import ICARUS, VERILATOR, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("DivisorWidth QuotientWidth")
STRUCTURES = (
    built(24, 25, on=VERILATOR),
    built(6, 5, on=ICARUS, mutants=True),
    built(3, 9, on=ICARUS),
    built(1, 2),
    built(15, 12),
)
REFUSED = {
    "DivisorWidth=0": "DivisorWidth_must_be_at_least_1_and_QuotientWidth_at_least_2",
    "QuotientWidth=1": "DivisorWidth_must_be_at_least_1_and_QuotientWidth_at_least_2",
}
PROOFS = (
    Proof(
        "quotient and remainder, or overflow, a fixed number of clocks after the last start",
        "every numerator and divisor; a bit is found in the same way at any width",
        {"DivisorWidth": 3, "QuotientWidth": 4, "Latency": td_divide.cycles(4)},
        depth=30,
    ),
)


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
