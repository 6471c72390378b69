# SPDX-License-Identifier: Apache-2.0
"""beat_sums: RTL against the model, and the model against numpy."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.chip.contact.beat_sums import beat_sums


@given(st.lists(st.tuples(st.booleans(), st.integers(1, 7)), min_size=8, max_size=8))
def test_sums_are_those_of_numpy(beat: list[tuple[bool, int]]) -> None:
    above, weights = (np.array(values) for values in zip(*beat, strict=True))
    weights = np.where(above, weights, 0)
    sums = beat_sums(above.tolist(), weights.tolist())
    offsets = np.flatnonzero(above)
    assert (sums.count, sums.weight) == (offsets.size, weights.sum())
    assert sums.moment == (weights * np.arange(8)[::-1]).sum()
    if offsets.size:
        assert (sums.least_offset, sums.greatest_offset) == (offsets[0], offsets[-1])
