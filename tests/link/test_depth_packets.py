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
MUTANTS = Mutants(repeats=1, flat=False)
REFUSED = {
    "Rows=1": "Rows_must_be_at_least_2",
    "Columns=12": "Columns_must_be_a_power_of_two_at_least_2",
    "DataWidth=33": "DataWidth_must_be_2_to_32",
    "Values=12": "Values_must_be_a_power_of_two_at_least_2",
}
PROOFS = (
    Proof(
        "each packet is its kind, number, position and Values values, or those that are left; then the trailer with "
        "the CRC over all values; an arbitrary value, and a bit of an arbitrary byte of the record, in their places",
        "positions are one formula for every power of two of columns; rounding is proven of depth_value, and the CRC "
        "is a function that the bench uses too",
        {"Rows": 3, "Columns": 2, "Values": 2},
        depth=32,
        engine="smtbmc bitwuzla -- --noincr",
        steps=8,
    ),
)
