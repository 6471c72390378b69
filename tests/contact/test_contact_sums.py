# SPDX-License-Identifier: Apache-2.0
"""contact_sums: RTL against the model, and the model against numpy on whole maps."""

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from tactile_depth.chip.contact.contact_sums import ContactSums, Sums


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
