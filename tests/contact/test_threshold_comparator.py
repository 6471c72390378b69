# SPDX-License-Identifier: Apache-2.0
"""threshold_comparator: RTL against the model."""

from formal.entries import FULL_WIDTH, Proof
from tb.structures import BOTH, ICARUS, VERILATOR, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("Width Lanes")
STRUCTURES = (
    built(12, 1, on=BOTH, mutants=True),
    built(32, 1, on=VERILATOR),
    built(12, 4, on=ICARUS, mutants=True),
    built(24, 32),
    built(32, 2),
)
REFUSED = {
    "Width=33": "Width_must_be_2_to_32",
    "Lanes=0": "Lanes_must_be_at_least_1",
}
PROOFS = tuple(
    Proof(
        "contact within one clock of a beat with a depth above the threshold, never otherwise",
        f"{FULL_WIDTH}; of several depths, which are only compared, any one decides",
        {"Width": width, "Lanes": lanes},
    )
    for width, lanes in ((24, 1), (4, 2))
)
