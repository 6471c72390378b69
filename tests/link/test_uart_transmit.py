# SPDX-License-Identifier: Apache-2.0
"""uart_transmit: RTL against the model."""

from formal.entries import Proof
from tb.structures import BOTH, Structure
from tests.rtl import test_rtl as test_rtl

STRUCTURES = (Structure({"Divider": 4}, on=BOTH, mutants=True), Structure({"Divider": 33}, late=BOTH))
PROOFS = (
    Proof(
        "each byte as a start bit, its bits and a stop bit, each for as many clocks; taken when the line is free",
        "clocks of a bit are only counted",
        depth=46,
    ),
)
