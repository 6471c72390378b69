# SPDX-License-Identifier: Apache-2.0
"""wide_corner_turn: RTL against the model, the order of its words."""

import numpy as np
import pytest

from formal.entries import ONE_ORDER, WORD_FREE, Proof
from tactile_depth.chip.poisson.transform.orders import makhoul
from tactile_depth.chip.poisson.transform.wide_corner_turn import wide_corner_turn
from tb.structures import ICARUS, VERILATOR, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("Size Width Paths")
STRUCTURES = (
    built(32, 24, 4, on=VERILATOR),
    built(16, 12, 1, on=ICARUS),
    built(32, 12, 8, on=ICARUS),
    built(16, 12, 2, on=ICARUS),
    built(8, 9, 2, on=ICARUS, mutants=True),
    built(64, 24, 16),
    built(128, 24, 4),
)
REFUSED = {
    "Size=12": "Size_must_be_a_power_of_two_at_least_8",
    "Paths=3": "Paths_must_be_a_power_of_two_1_to_Size_4",
    "Paths=64": "Paths_must_be_a_power_of_two_1_to_Size_4",
}
PROOFS = tuple(
    Proof(
        "an arbitrary word at its place in its row; rows in turn, one alone; latency Beats + 4",
        f"{ONE_ORDER}; {WORD_FREE}",
        {"Size": size, "Paths": paths},
        depth=45,
        engine="smtbmc bitwuzla -- --noincr",
        steps=2,
    )
    for size, paths in ((8, 1), (8, 2), (16, 4))
)


@pytest.mark.parametrize("paths", [1, 2, 8])
def test_beats_have_neighbours(paths: int) -> None:
    beats = wide_corner_turn(makhoul(32), paths)
    np.testing.assert_array_equal(beats, np.arange(32).reshape(-1, 2 * paths))
