# SPDX-License-Identifier: Apache-2.0
"""td_axis_skid: RTL against the model."""

from formal.entries import WORD_FREE, Proof
from tb.structures import BOTH, Structure
from tests.rtl import test_rtl as test_rtl

STRUCTURES = (Structure({"Width": 26}, on=BOTH, mutants=True),)
PROOFS = (Proof("no word lost, repeated, reordered or changed; stable under stall; latency 1", WORD_FREE),)
