# SPDX-License-Identifier: Apache-2.0
"""contact_peak: RTL against the model, and the model against numpy on whole maps."""

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from formal.entries import Proof
from tactile_depth.chip.contact.contact_peak import ContactPeak, Peak
from tb.structures import ICARUS, VERILATOR, Refused, Structure, of_parameters
from tests.rtl import test_rtl as test_rtl

built = of_parameters("Width Rows Columns Lanes BottomFirst")


def structures(columns: int) -> tuple[Structure, ...]:
    """Return the structures of a core that measures frames, with the columns of the first one that has mutants."""
    return (
        built(24, 5, 8, 1, 0, on=VERILATOR),
        built(6, 5, columns, 1, 1, on=ICARUS, mutants=True),
        built(6, 5, 8, 4, 1, on=ICARUS, mutants=True),
        built(6, 5, 8, 1, 0),
        built(32, 5, 16, 1, 1),
        built(12, 9, 4, 1, 0),
        built(24, 5, 16, 2, 0),
        built(12, 3, 128, 64, 1),
        built(32, 5, 16, 8, 1),
    )


def refused(missing: str) -> dict[str, Any]:
    """Return the refused parameters of such a core; Verilator stops earlier, for want of a name."""
    rule = "Lanes_must_be_a_power_of_two_up_to_64_that_divides_Columns"
    return {"Lanes=3": Refused(rule, {"verilator": f"can't find definition of '{missing}'"}), "Lanes=128": rule}


def proofs(claim: str, bounds: str) -> tuple[Proof, ...]:
    """Return the proofs of such a core, for both orders of rows, and for one and two depths per beat."""
    return tuple(
        Proof(claim, bounds, {"BottomFirst": bottom_first, "Columns": columns, "Lanes": lanes}, depth=30)
        for bottom_first, columns, lanes in ((0, 3, 1), (1, 3, 1), (0, 4, 2), (1, 4, 2))
    )


STRUCTURES = structures(7)
REFUSED = refused("some")
PROOFS = proofs(
    "count 2 and peak 3 + log2(Lanes) clocks after a frame's last beat; the peak is none below what is above, and "
    "is attained first",
    "positions are only counted; either order of rows; the peak of a beat of several depths is proven of beat_peak",
)


@given(arrays(np.int64, (5, 8), elements=st.integers(-8, 7)), st.integers(-9, 8), st.booleans())
def test_the_peak_is_that_of_numpy(depth: Any, threshold: int, bottom_first: bool) -> None:
    model = ContactPeak(5, 8, bottom_first)
    stream = depth[::-1] if bottom_first else depth
    for index, code in enumerate(stream.ravel()):
        found = model.beat(int(code), index == 0, index % 8 == 7, index == 39, threshold)
    assert found == ContactPeak(5, 8, bottom_first).whole_frame(stream, threshold)
    count = int(np.count_nonzero(depth > threshold))
    if not count:
        assert found == Peak()
        return
    assert found is not None
    assert (found.above, found.peak) == (count, int(depth.max()))
    assert depth[found.position] == found.peak
    row, column = found.position
    place = (4 - row if bottom_first else row) * 8 + column
    assert (stream.ravel()[:place] < found.peak).all(), "not the first of equal peaks"
