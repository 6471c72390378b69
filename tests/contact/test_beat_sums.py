# SPDX-License-Identifier: Apache-2.0
"""beat_sums: RTL against the model, and the model against numpy."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tactile_depth.contact.beat_sums import beat_sums

DEPTH = st.tuples(st.booleans(), st.integers(-4, 3))


@pytest.mark.structures(
    "width lanes", verilator=[(24, 8)], icarus=[(6, 4), (6, 2)], regress=[(24, 8), (32, 32), (12, 16)]
)
def test_rtl(run_tb: Callable[..., None], width: int, lanes: int) -> None:
    run_tb("beat_sums", {"Width": width, "Lanes": lanes})


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
