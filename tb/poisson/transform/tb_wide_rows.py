# SPDX-License-Identifier: Apache-2.0
"""wide_rows against its model: the tests that it shares with row_reorder."""

from formal.entries import ONE_ORDER, WORD_FREE, Proof
from tb.poisson.transform.row_bench import a_frame_begins_afresh, reset_in_mid_row, rows
from tb.structures import ICARUS, VERILATOR, of_parameters

built = of_parameters("Columns Width Paths")
STRUCTURES = (
    built(32, 24, 4, on=VERILATOR),
    built(16, 16, 2, on=ICARUS),
    built(8, 16, 2, on=ICARUS, mutants=ICARUS),
    built(8, 8, 4, on=ICARUS),
    built(64, 24, 8),
)
PROOFS = tuple(Proof(f"{ONE_ORDER}; {WORD_FREE}", {"Columns": 8, "Paths": paths}) for paths in (2, 4))


__all__ = ["a_frame_begins_afresh", "reset_in_mid_row", "rows"]
