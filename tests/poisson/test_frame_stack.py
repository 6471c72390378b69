# SPDX-License-Identifier: Apache-2.0
"""frame_stack: RTL against the model."""

from formal.entries import WORD_FREE, Proof
from tb.structures import ICARUS, VERILATOR, Mutants, Refused, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("Columns Width Rows WordsPerRow")
STRUCTURES = (
    built(16, 24, 8, 3, on=VERILATOR),
    built(8, 16, 3, 1, on=ICARUS),
    built(4, 4, 3, 1, on=ICARUS),
    built(8, 16, 3, 2, on=ICARUS),
    built(4, 4, 4, 3, on=ICARUS, mutants=True),
    built(4, 4, 4, 2),
    built(5, 6, 2, 2),
    built(2, 5, 2, 6),
    built(8, 16, 2, 1),
    built(16, 16, 17, 1),
    built(16, 9, 17, 3),
    built(16, 12, 5, 6),
)
REFUSED = {
    "Columns=1": Refused(
        "Columns_must_be_at_least_2",
        {
            "icarus": "cast size expression must be constant and greater than zero",
            "verilator": "size-changing cast to zero or negative size",
        },
    ),
    "Rows=1": "Rows_must_be_at_least_2",
    "WordsPerRow=0": Refused("WordsPerRow_must_be_at_least_1", {"verilator": "depth_must_be_at_least_2"}),
}
MUTANTS = Mutants("bursts")
PROOFS = tuple(
    Proof(
        "an arbitrary word at its place, last row first; latency 3 from the first word of the last row",
        "rows, positions and memory rows are only counted; rows and memory rows no power of two, and one; words to "
        f"a memory row that divide a burst, and not; {WORD_FREE}",
        {"Rows": rows, "Columns": size, "WordsPerRow": words},
        depth=3 * rows * size + 5,
    )
    for rows, size, words in (
        (3, 4, 1),
        (4, 4, 1),
        (3, 4, 2),
        (3, 4, 3),
        (3, 5, 3),
        (2, 3, 3),
    )
)
