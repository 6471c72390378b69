# SPDX-License-Identifier: Apache-2.0
"""wide_stack: RTL against the model."""

from formal.entries import WORD_FREE, Proof
from tb.structures import ICARUS, VERILATOR, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("Columns Width Rows InWords OutWords")
STRUCTURES = (
    built(32, 24, 9, 4, 16, on=VERILATOR),
    built(16, 16, 8, 2, 8, on=ICARUS),
    built(16, 16, 5, 2, 2, on=ICARUS, mutants=True),
    built(16, 12, 4, 2, 4, on=ICARUS, mutants=True),
    built(64, 16, 3, 4, 32, on=ICARUS),
    built(64, 16, 7, 8, 16),
    built(128, 16, 9, 8, 64),
)
RULE = "InWords_OutWords_Columns_must_be_rising_powers_of_two_with_2_beats_and_4_clocks_in_a_row"
REFUSED = {"InWords=3": RULE, "InWords=64": RULE, "OutWords=24": RULE, "OutWords=128": RULE, "Columns=96": RULE}
REFUSED |= {"Rows=2": "Rows_must_be_at_least_3"}
PROOFS = tuple(
    Proof(
        "an arbitrary word at its place, last row first; fixed latency, starts of pairs, and the pair that is one row",
        "rows and beats are only counted; a memory with the words of a clock, and one with a part of them; an even and "
        f"an odd number of rows; {WORD_FREE}",
        {"Rows": rows, "Columns": columns, "InWords": in_words, "OutWords": out_words},
        depth=4 * rows * columns // in_words,
        engine="smtbmc bitwuzla -- --noincr",
        steps=2,
    )
    for rows, columns, in_words, out_words in ((3, 8, 2, 4), (4, 8, 2, 4), (4, 16, 2, 2))
)
