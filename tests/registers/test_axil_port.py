# SPDX-License-Identifier: Apache-2.0
"""axil_port: RTL against the model."""

from formal.entries import FULL_WIDTH, Proof
from tb.structures import BOTH, Mutants, Structure
from tests.rtl import test_rtl as test_rtl

STRUCTURES = (Structure(on=BOTH, mutants=True),)
MUTANTS = Mutants(protocol="axil_registers")
PROOFS = (
    Proof(
        "AXI4-Lite rules; each access reaches the registers once, with its own words, and has its own answer",
        FULL_WIDTH,
    ),
)
