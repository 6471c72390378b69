# SPDX-License-Identifier: Apache-2.0
"""frame_output: RTL against the model."""

from formal.entries import WORD_FREE, Proof
from tb.structures import BOTH, Structure
from tests.rtl import test_rtl as test_rtl

STRUCTURES = (
    Structure({"Width": 24, "Rows": 4, "Columns": 8}, on=BOTH),
    Structure({"Width": 12, "Rows": 16, "Columns": 2}, on=BOTH, mutants=True),
)
REFUSED = {
    "Columns=12": "Columns_must_be_a_power_of_two_at_least_2",
    "Rows=1": "Rows_must_be_at_least_2",
}
PROOFS = (
    Proof(
        "whole good frames with their side-bands, nothing of the others; out of step is said",
        f"rows and columns are only counted; {WORD_FREE}",
        {"Rows": 3, "Columns": 4},
        depth=20,
    ),
)
