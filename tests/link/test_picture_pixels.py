# SPDX-License-Identifier: Apache-2.0
"""picture_pixels: RTL against the model of the device; tests/link/test_device.py tests that."""

from formal.entries import Proof
from tb.structures import BOTH, ICARUS, VERILATOR, Mutants, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("Rows Columns")
STRUCTURES = (
    built(12, 16, on=VERILATOR),
    built(3, 4, on=ICARUS, mutants=True),
    built(5, 6, late=BOTH),
    built(2, 300),
)
MUTANTS = Mutants(repeats=4)
REFUSED = {
    "Rows=0": "Rows_must_be_1_to_4096",
    "Rows=4097": "Rows_must_be_1_to_4096",
    "Columns=0": "Columns_must_be_1_to_4096",
    "Columns=4097": "Columns_must_be_1_to_4096",
}
PROOFS = (
    Proof(
        "a pixel leaves the clock after its last byte, exactly if its packet begins a picture or goes on with it and "
        "the picture lacks it, with its bytes and marks",
        "rows and columns are only counted",
        {"Rows": 2, "Columns": 3},
        depth=34,
    ),
)
