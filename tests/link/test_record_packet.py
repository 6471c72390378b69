# SPDX-License-Identifier: Apache-2.0
"""record_packet: RTL against the function that packs a record."""

from formal.entries import WORD_FREE, Proof
from tb.structures import BOTH, Mutants, Structure
from tests.rtl import test_rtl as test_rtl

STRUCTURES = (Structure(on=BOTH, mutants=True),)
MUTANTS = Mutants(flat=False)
PROOFS = (
    Proof(
        "whole packets of the kind and the 48 bytes of the newest record that was there as the first byte was taken",
        f"the size in use; one bit of an arbitrary word is followed: {WORD_FREE}",
        depth=30,
    ),
)
