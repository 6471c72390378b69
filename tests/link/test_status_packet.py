# SPDX-License-Identifier: Apache-2.0
"""status_packet: RTL against the model."""

from tb.structures import BOTH, Structure
from tests.rtl import test_rtl as test_rtl

STRUCTURES = (Structure(on=BOTH, mutants=True),)
