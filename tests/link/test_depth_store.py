# SPDX-License-Identifier: Apache-2.0
"""depth_store: RTL against what was written, with the model of the banks."""

from formal.entries import WORD_FREE, Proof
from tb.structures import ICARUS, VERILATOR, Mutants, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("Rows Columns DataWidth Lanes")
STRUCTURES = (
    built(5, 8, 24, 2, on=VERILATOR),
    built(3, 4, 12, 1, on=ICARUS, mutants=True),
    built(3, 4, 5, 2, on=ICARUS, mutants=True),
    built(6, 16, 20, 4),
    built(2, 2, 8, 1),
)
MUTANTS = Mutants(repeats=4, flat=False)
REFUSED = {
    "Columns=12": "Columns_must_be_a_power_of_two_at_least_2",
    "Lanes=3": "Lanes_must_divide_Columns",
    "Rows=1": "Rows_must_be_at_least_2",
    "DataWidth=1": "DataWidth_must_be_at_least_2",
}
PROOFS = tuple(
    Proof(
        "each value and word that is read is that of the frame taken, which came whole with its record and was the "
        "newest; the memories' rules",
        f"values and words are only stored, and an arbitrary one is followed; {WORD_FREE}",
        {"Rows": 2, "Columns": 2 * lanes, "Lanes": lanes},
        depth=30,
    )
    for lanes in (1, 2)
)
