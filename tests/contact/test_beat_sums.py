# SPDX-License-Identifier: Apache-2.0
"""beat_sums: RTL against the model, and the model against numpy."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from formal.entries import Proof
from tactile_depth.contact.beat_sums import beat_sums
from tb.structures import ICARUS, VERILATOR, Refused, of_parameters
from tests.rtl import test_rtl as test_rtl

DEPTH = st.tuples(st.booleans(), st.integers(-4, 3))


built = of_parameters("Width Lanes")
STRUCTURES = (
    built(24, 8, on=VERILATOR),
    built(6, 4, on=ICARUS, mutants=True),
    built(6, 2, on=ICARUS),
    built(32, 32),
    built(12, 16),
)
REFUSED = {
    "Lanes=1": Refused("Lanes_must_be_a_power_of_two_at_least_2", {"verilator": "can't find definition of 'top_at'"}),
    "Lanes=12": "Lanes_must_be_a_power_of_two_at_least_2",
}
PROOFS = (Proof("sums, limits and peak of an arbitrary beat, 2 clocks later", "sums are exact at any width"),)


@given(st.lists(DEPTH, min_size=8, max_size=8))
def test_sums_are_those_of_numpy(beat: list[tuple[bool, int]]) -> None:
    above, depths = (np.array(values) for values in zip(*beat, strict=True))
    sums = beat_sums(above.tolist(), depths.tolist())
    offsets = np.flatnonzero(above)
    assert (sums.count, sums.offset_sum) == (offsets.size, offsets.sum())
    assert sums.volume == depths[above].sum()
    if offsets.size:
        assert (sums.peak, sums.least_offset, sums.greatest_offset) == (depths[above].max(), offsets[0], offsets[-1])
        assert sums.peak_offset == offsets[depths[above].argmax()]
