# SPDX-License-Identifier: Apache-2.0
"""contact_peak: RTL against the model, and the model against numpy on whole maps."""

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from tactile_depth.chip.contact.contact_peak import ContactPeak, Peak


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
