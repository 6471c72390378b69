# SPDX-License-Identifier: Apache-2.0
"""row_reorder against its model: the tests that it shares with wide_rows."""

from formal.entries import ONE_ORDER, WORD_FREE, Proof
from tb.poisson.transform.row_bench import a_frame_begins_afresh, reset_in_mid_row, rows
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Columns Width ToBurst")
STRUCTURES = (
    built(16, 24, 1, on=VERILATOR),
    built(16, 24, 0, on=ICARUS),
    built(8, 12, 1, on=ICARUS, mutants=ICARUS),
    built(8, 12, 0),
    built(64, 35, 1),
    built(64, 35, 0),
)
PROTOCOL = "protocol_words"
PROOFS = tuple(
    Proof(f"{ONE_ORDER}; {WORD_FREE}", {"Columns": size, "ToBurst": to_burst}) for size in (4, 8) for to_burst in (0, 1)
)


__all__ = ["a_frame_begins_afresh", "reset_in_mid_row", "rows"]
