# SPDX-License-Identifier: Apache-2.0
"""uart_receive: RTL against the model."""

from formal.entries import Proof
from tb.structures import BOTH, Structure
from tests.rtl import test_rtl as test_rtl

STRUCTURES = (Structure({"Divider": 4}, on=BOTH, mutants=True), Structure({"Divider": 33}, late=BOTH))
REFUSED = {"Divider=3": "Divider_must_be_at_least_4"}
PROOFS = (
    Proof(
        "a byte has the levels in the middle of its bits and leaves in its clock; a low stop bit breaks it, and "
        "nothing begins until the line is high",
        "clocks of a bit are only counted",
        depth=46,
    ),
)
