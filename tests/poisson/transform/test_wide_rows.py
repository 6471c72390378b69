# SPDX-License-Identifier: Apache-2.0
"""wide_rows: RTL against the model, the order of its words."""

import numpy as np
import pytest

from formal.entries import ONE_ORDER, WORD_FREE, Proof
from tactile_depth.chip.poisson.transform.orders import makhoul
from tactile_depth.chip.poisson.transform.wide_rows import wide_rows
from tb.structures import ICARUS, VERILATOR, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("Columns Width Paths")
STRUCTURES = (
    built(32, 24, 4, on=VERILATOR),
    built(16, 16, 2, on=ICARUS),
    built(8, 16, 2, on=ICARUS, mutants=True),
    built(8, 8, 4, on=ICARUS),
    built(64, 24, 8),
)
REFUSED = {
    "Columns=12": "Columns_must_be_a_power_of_two_at_least_4",
    "Columns=2": "Columns_must_be_a_power_of_two_at_least_4",
    "Paths=1": "Paths_must_be_a_power_of_two_2_to_Columns_2",
    "Paths=3": "Paths_must_be_a_power_of_two_2_to_Columns_2",
    "Paths=128": "Paths_must_be_a_power_of_two_2_to_Columns_2",
}
PROOFS = tuple(
    Proof(
        "an arbitrary word at its place in its row; start with the last word of the row",
        f"{ONE_ORDER}; {WORD_FREE}",
        {"Columns": 8, "Paths": paths},
        depth=45,
    )
    for paths in (2, 4)
)


@pytest.mark.parametrize("paths", [2, 4, 8])
def test_a_path_has_neighbours_in_makhoul_order(paths: int) -> None:
    size = 16
    beats = wide_rows(np.arange(size), paths)
    np.testing.assert_array_equal(beats.T.ravel(), makhoul(size))
