# SPDX-License-Identifier: Apache-2.0
"""depth_gate: RTL against the model."""

from tb.structures import BOTH, Structure
from tests.rtl import test_rtl as test_rtl

STRUCTURES = (Structure({"Width": 12}, on=BOTH, mutants=True),)
