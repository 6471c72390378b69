# SPDX-License-Identifier: Apache-2.0
"""depth_gate: RTL against the model."""

from formal.entries import WORD_FREE, Proof
from tb.structures import BOTH, Structure
from tests.rtl import test_rtl as test_rtl

STRUCTURES = (Structure({"Width": 12}, on=BOTH, mutants=True),)
PROOFS = (
    Proof(
        "all words of a frame that waits, the first ones of one that does not; each looked at once, in time",
        f"words of a frame are only counted; {WORD_FREE}",
        depth=30,
    ),
)
