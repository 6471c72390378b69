# SPDX-License-Identifier: Apache-2.0
"""contact_peak: the model of whole frames against that of single depths."""

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from tactile_depth.chip.contact.contact_peak import ContactPeak


@given(arrays(np.int64, (5, 8), elements=st.integers(-8, 7)), st.integers(-9, 8), st.booleans())
def test_the_peak_of_a_whole_frame_is_that_of_its_depths(depth: Any, threshold: int, bottom_first: bool) -> None:
    model = ContactPeak(5, 8, bottom_first)
    stream = depth[::-1] if bottom_first else depth
    for index, code in enumerate(stream.ravel()):
        found = model.beat(int(code), index == 0, index % 8 == 7, index == 39, threshold)
    assert found == ContactPeak(5, 8, bottom_first).whole_frame(stream, threshold)
