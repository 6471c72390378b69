# SPDX-License-Identifier: Apache-2.0
"""td_async_fifo: RTL against the model."""

from formal.entries import WORD_FREE, Proof
from tb.structures import BOTH, ICARUS, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("Width DepthLog2")
STRUCTURES = (
    built(10, 4, on=BOTH),
    built(3, 2, on=ICARUS, mutants=True),
)
REFUSED = {
    "DepthLog2=1": "DepthLog2_must_be_at_least_2",
}
PROOFS = (
    Proof(
        "no word lost, repeated, reordered or changed, for clocks of any ratio and wires of any delay below a period; "
        "stable under stall; words and room are seen within 4 clocks of a code's arrival",
        f"codes of three bits, words are only counted; {WORD_FREE}",
        depth=60,
        free=("written_code_q", "fetched_code_q"),
        clocks=2,
    ),
)
