# SPDX-License-Identifier: Apache-2.0
"""frame_tags: RTL against the model."""

from formal.entries import WORD_FREE, Proof
from tb.structures import ICARUS, VERILATOR, of_parameters
from tests.rtl import test_rtl as test_rtl

# Two frames in flight, one, exactly two, four; the first again, for mutants.
built = of_parameters("Width Latency Pixels")
STRUCTURES = (
    built(33, 37, 24, on=VERILATOR),
    built(4, 9, 16, on=ICARUS),
    built(33, 32, 16),
    built(33, 50, 13),
    built(4, 9, 6, mutants=True),
)
PROOFS = tuple(
    Proof(
        "an arbitrary tag is due exactly Latency enabled clocks after it was pushed, nothing else ever",
        f"one, two and three places; {WORD_FREE}",
        {"Latency": latency, "Pixels": pixels},
        depth=30,
    )
    for latency, pixels in ((3, 4), (5, 4), (7, 3))
)
