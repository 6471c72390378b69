# SPDX-License-Identifier: Apache-2.0
"""corner_turn: RTL against the model, the model against Makhoul's order."""

import numpy as np

from formal.entries import ONE_ORDER, WORD_FREE, Proof
from tactile_depth.poisson.transform.corner_turn import corner_turn
from tb.structures import ICARUS, VERILATOR, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("Columns Width Lanes")
STRUCTURES = (
    built(32, 24, 4, on=VERILATOR),
    built(16, 12, 2, on=ICARUS),
    built(16, 12, 4, on=ICARUS, mutants=True),
    built(64, 12, 8, on=ICARUS),
    built(128, 24, 16),
    built(256, 24, 32),
    built(64, 24, 32),
)
REFUSED = {
    "Lanes=1": "Lanes_and_Columns_must_be_powers_of_two_of_at_least_2_and_2_Lanes",
    "Lanes=12": "Lanes_and_Columns_must_be_powers_of_two_of_at_least_2_and_2_Lanes",
    "Lanes=128": "Lanes_and_Columns_must_be_powers_of_two_of_at_least_2_and_2_Lanes",
    "Columns=96": "Lanes_and_Columns_must_be_powers_of_two_of_at_least_2_and_2_Lanes",
}
PROOFS = tuple(
    Proof(
        "an arbitrary word at its place in its row, rows in turn; latency 3 from the last word of a row",
        f"{ONE_ORDER}; two lanes, and the fewest with more than one memory for each half; {WORD_FREE}",
        {"Columns": size, "Lanes": lanes},
        depth=36,
    )
    for size, lanes in ((4, 2), (8, 4))
)


def test_a_beat_holds_even_words_of_the_first_half_and_odd_words_of_the_second() -> None:
    assert corner_turn(np.arange(8)[None], 4).tolist() == [[[0, 7, 1, 6], [2, 5, 3, 4]]]
