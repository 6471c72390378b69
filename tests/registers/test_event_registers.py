# SPDX-License-Identifier: Apache-2.0
"""event_registers: RTL against the model."""

from tb.structures import BOTH, Mutants, Structure
from tests.rtl import test_rtl as test_rtl

STRUCTURES = (Structure(on=BOTH, mutants=True),)
MUTANTS = Mutants(protocol="after_reset", outside=("counts",))
NO_PROOF = "every register and output of it is proven through the port: axil_registers"
