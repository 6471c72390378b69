# SPDX-License-Identifier: Apache-2.0
"""contact_sums: RTL against the model, and the model against numpy on whole maps."""

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from formal.entries import Proof
from tactile_depth.chip.contact.contact_sums import ContactSums, Sums
from tb.structures import ICARUS, VERILATOR, Refused, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("Width Rows Columns Lanes BottomFirst")
STRUCTURES = (
    built(24, 5, 8, 1, 0, on=VERILATOR),
    built(6, 5, 8, 1, 1, on=ICARUS, mutants=True),
    built(6, 5, 8, 4, 1, on=ICARUS, mutants=True),
    built(6, 5, 8, 1, 0),
    built(32, 5, 16, 1, 1),
    built(12, 9, 4, 1, 0),
    built(24, 5, 16, 2, 0),
    built(12, 3, 128, 64, 1),
    built(32, 5, 16, 8, 1),
)
REFUSED = {
    "Lanes=3": Refused(
        "Lanes_must_be_a_power_of_two_up_to_64_that_divides_Columns", {"verilator": "can't find definition of 'first'"}
    ),
    "Lanes=128": "Lanes_must_be_a_power_of_two_up_to_64_that_divides_Columns",
}
PROOFS = tuple(
    Proof(
        "sums 2 + log2(Lanes) clocks after a frame's last beat: area, weight and moments of all that is above; limits "
        "enclose it, and are attained",
        "positions are only counted; sums are exact at any width; either order of rows; the sums of a beat of "
        "several depths are proven of beat_sums",
        {"BottomFirst": bottom_first, "Columns": columns, "Lanes": lanes},
        depth=30,
    )
    for bottom_first, columns, lanes in ((0, 3, 1), (1, 3, 1), (0, 4, 2), (1, 4, 2))
)


@given(arrays(np.int64, (5, 8), elements=st.integers(-8, 7)), st.integers(-8, 7), st.booleans())
def test_sums_are_those_of_numpy(depth: Any, threshold: int, bottom_first: bool) -> None:
    model = ContactSums(5, 8, bottom_first)
    stream = depth[::-1] if bottom_first else depth
    for index, code in enumerate(stream.ravel()):
        sums = model.beat(int(code), index == 0, index == 39, threshold)
    rows, columns = np.nonzero(depth > threshold)
    if not rows.size:
        assert sums == Sums()
        return
    assert sums is not None
    weights = depth[rows, columns] - threshold
    last_row = 0 if bottom_first else 4
    assert (sums.area, sums.weight) == (rows.size, weights.sum())
    assert sums.row_moment == (weights * abs(last_row - rows)).sum()
    assert sums.column_moment == (weights * (7 - columns)).sum()
    assert (sums.least, sums.greatest) == ((rows.min(), columns.min()), (rows.max(), columns.max()))
