# SPDX-License-Identifier: Apache-2.0
"""depth_packets: RTL against the packets of the models."""

from formal.entries import Proof
from tb.structures import ICARUS, VERILATOR, Mutants, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("Rows Columns DataWidth BottomFirst Values")
STRUCTURES = (
    built(9, 32, 24, 1, 256, on=VERILATOR),
    built(5, 4, 24, 0, 8, on=ICARUS),
    built(3, 4, 12, 1, 4, on=ICARUS, mutants=True),
    built(3, 2, 12, 1, 2),
    built(2, 8, 32, 0, 16),
    built(6, 16, 8, 0, 32),
)
MUTANTS = Mutants(repeats=1)
REFUSED = {
    "Rows=1": "Rows_must_be_at_least_2",
    "Columns=12": "Columns_must_be_a_power_of_two_at_least_2",
    "DataWidth=33": "DataWidth_must_be_2_to_32",
    "Values=12": "Values_must_be_a_power_of_two_at_least_2",
}
PROOFS = (
    Proof(
        "each packet is its kind, number, position and Values values, or those that are left; then the trailer with the "
        "CRC over all values; one bit of an arbitrary value and of an arbitrary word of the record is that of its place",
        "counts and positions are one formula for every power of two of columns; values are proven of depth_value, the "
        "CRC is one function of td_link_pkg",
        {"Rows": 3, "Columns": 2, "Values": 2},
        depth=24,
        engine="smtbmc bitwuzla -- --noincr",
        steps=8,
    ),
)
