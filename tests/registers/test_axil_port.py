# SPDX-License-Identifier: Apache-2.0
"""axil_port: RTL against the model."""

from tb.structures import BOTH, Mutants, Structure
from tests.rtl import test_rtl as test_rtl

STRUCTURES = (Structure(on=BOTH, mutants=True),)
MUTANTS = Mutants(protocol="axil_registers")
