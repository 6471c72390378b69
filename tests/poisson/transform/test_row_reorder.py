# SPDX-License-Identifier: Apache-2.0
"""row_reorder: RTL against the model, the model against Makhoul's order."""

import numpy as np
import pytest

from formal.entries import ONE_ORDER, WORD_FREE, Proof
from tactile_depth.chip.poisson.transform.row_reorder import row_reorder
from tb.structures import ICARUS, VERILATOR, Mutants, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("Columns Width ToBurst")
STRUCTURES = (
    built(16, 24, 1, on=VERILATOR),
    built(16, 24, 0, on=ICARUS),
    built(8, 12, 1, on=ICARUS, mutants=True),
    built(8, 12, 0),
    built(64, 35, 1),
    built(64, 35, 0),
)
MUTANTS = Mutants("words")
REFUSED = {
    "Columns=12": "Columns_must_be_a_power_of_two_at_least_4",
    "Columns=2": "Columns_must_be_a_power_of_two_at_least_4",
}
PROOFS = tuple(
    Proof(
        "an arbitrary word at its place in the burst; latency 2 from the last word of a row",
        f"{ONE_ORDER}; {WORD_FREE}",
        {"Columns": size, "ToBurst": to_burst},
        depth=2 * size + 12,
    )
    for size in (4, 8)
    for to_burst in (0, 1)
)


def test_makhoul_order_is_even_samples_up_then_odd_ones_down() -> None:
    assert row_reorder(np.arange(8), to_burst=True).tolist() == [0, 2, 4, 6, 7, 5, 3, 1]


@pytest.mark.parametrize("columns", [8, 128, 512])
def test_there_and_back_is_the_row(columns: int) -> None:
    rows = np.arange(3 * columns).reshape(3, columns)
    for first in (True, False):
        np.testing.assert_array_equal(row_reorder(row_reorder(rows, first), not first), rows)
