# SPDX-License-Identifier: Apache-2.0
"""status_packet: RTL against the model."""

from formal.entries import Proof
from tb.structures import BOTH, Structure
from tests.rtl import test_rtl as test_rtl

STRUCTURES = (Structure(on=BOTH, mutants=True),)
PROOFS = (
    Proof(
        "a packet after each reset, and one for the requests since the last one began; its fields are those of the "
        "clock in which its first byte is taken",
        "fields leave alike; three bytes of them",
    ),
)
