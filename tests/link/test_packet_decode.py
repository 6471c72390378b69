# SPDX-License-Identifier: Apache-2.0
"""packet_decode: RTL against unpack of the host's packets."""

from formal.entries import Proof
from tb.structures import BOTH, QUICK_FIRST, Mutants, Structure
from tests.rtl import test_rtl as test_rtl

STRUCTURES = (Structure(on=BOTH, mutants=True),)
MUTANTS = Mutants(simulators=QUICK_FIRST)
PROOFS = (
    Proof(
        "each packet does what its kind says if length and fields are good, in order; another one is said to be bad, "
        "or dropped if its kind is unknown; the streams are whole and stable",
        "the widths in use",
        engine="smtbmc bitwuzla -- --noincr",
        steps=3,
    ),
)
