# SPDX-License-Identifier: Apache-2.0
"""depth_value: RTL against the functions of the depth formats."""

from formal.entries import Proof
from tb.structures import ICARUS, VERILATOR, Mutants, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("DataWidth")
STRUCTURES = (
    built(24, on=VERILATOR, mutants=True),
    built(12, on=ICARUS),
    built(32, on=ICARUS),
    built(16),
    built(2),
)
MUTANTS = Mutants(repeats=4)
REFUSED = {"DataWidth=1": "DataWidth_must_be_at_least_2"}
PROOFS = (
    Proof(
        "the sum of the codes, divided and rounded once as td_round_saturate does for each shift, 3 clocks later",
        "the sum and the rounding are one formula for every width; 20 bits are rounded with every shift, and clip",
        {"DataWidth": 20},
        depth=8,
        engine="smtbmc bitwuzla -- --noincr",
        steps=6,
    ),
)
