# SPDX-License-Identifier: Apache-2.0
"""dvp_receive: RTL against the model."""

from formal.entries import Proof
from tb.structures import BOTH, ICARUS, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("FifoLog2")
STRUCTURES = (
    built(4, on=BOTH),
    built(3, on=ICARUS, mutants=True),
)
REFUSED = {
    "FifoLog2=2": "FifoLog2_must_be_at_least_3_or_nearly_equal_clocks_lose_every_frame",
}
PROOFS = (
    Proof(
        "a front for each frame, its bytes without a hole up to the first without room; each frame given up counted "
        "once; out of the queue the same, from the first front after a reset on",
        "the widths in use; td_async_fifo is proven by itself",
        free=("write_ready", "read_valid", "word"),
        clocks=2,
    ),
)
